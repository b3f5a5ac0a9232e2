#pragma once

#include "loop/core/expected.hpp"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// What the columns of a motion of another program are, by a line before its names:
///
///     # columns: Wrist X = x_mm, Wrist Y = y_mm, Wrist Z = z_mm, up = y, rate_hz = 120
///
/// On the left stands a name as the motion has it, on the right one that motions have here. `up` is
/// the axis that points up, `rate_hz` the samples a second where no column is a time. A name with a
/// comma stands in double quotes.
struct ColumnMap {
  std::map<std::string, std::string> columns;
  double rate_hz = 0.0;  ///< 0: a column is the time
  char up = 0;           ///< 'y' or 'z'; 0: not given
};

/// True for a line that readColumnMap() reads.
[[nodiscard]] bool isColumnMap(std::string_view line);

/// Adds what a line says to the map. @return the faults of its entries, without file and line
[[nodiscard]] Diagnostics readColumnMap(std::string_view line, ColumnMap& map);

/// Takes a column's name out of the map. @return what it is, else `text`; it has the unit of the
/// column where the map gives none
[[nodiscard]] std::string takeName(ColumnMap& map, const std::string& text);

/// The line that names columns which are no axis, so that they are read: the first three that end
/// in x, y, z and may be a place, else the last one that may be the angle of a finger; empty: none
/// may be either. Rates, accelerations and quaternions are no places.
/// @param names of the columns
[[nodiscard]] std::string exampleOfMap(const std::vector<std::string>& names, bool has_time);

}  // namespace wholehand
