#pragma once

#include "files/patient/csv_line.hpp"
#include "loop/core/expected.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace wholehand {

/// What the columns of a motion of another program are, by a line before its names:
///
///     # columns: Wrist X = x_mm, Wrist Y = y_mm, Wrist Z = z_mm, up = y, rate_hz = 120
///
/// On the left stands a name as the motion has it, on the right one that motions have here. `up` is
/// the axis that points up, `rate_hz` the samples a second where no column is a time. A name with a
/// comma stands in double quotes. `Landmark = only 0` keeps the rows that have 0 there, of a motion
/// with a row for each part of a hand.
struct ColumnMap {
  std::map<std::string, std::string> columns;
  std::map<std::string, std::string> only;  ///< what a column has in the rows that are read
  double rate_hz = 0.0;                     ///< 0: a column is the time
  char up = 0;                              ///< 'y' or 'z'; 0: not given
};

/// True for a line that readColumnMap() reads.
[[nodiscard]] bool isColumnMap(std::string_view line);

/// Adds what a line says to the map. @return the faults of its entries, without file and line
[[nodiscard]] Diagnostics readColumnMap(std::string_view line, ColumnMap& map);

/// Takes a column's name out of the map. @return what it is, else `text`; it has the unit of the
/// column where the map gives none
[[nodiscard]] std::string takeName(ColumnMap& map, const std::string& text);

/// What a motion shows of itself before its samples are read.
struct MotionHead {
  std::vector<std::string> names;                           ///< of all columns
  std::vector<std::vector<Cell>> rows;                      ///< the first ones
  bool has_axis = false, has_time = false, has_up = false;  ///< already named
  /// Columns that have the name of an axis and no unit; true: a translation.
  std::vector<std::pair<std::size_t, bool>> bare;
};

/// Columns that number the parts of a frame, where the first rows have several for each frame or
/// time, and what they have in the likeliest of these: to be read alone. Empty: a row is a frame.
[[nodiscard]] std::map<std::string, std::string> partsOfFrame(const MotionHead& head);

/// The line that makes a motion playable: it names three columns that differ in x, y, z and may be
/// a place, of the hand if its name says so, else axes without a unit, else the last column that
/// may be the angle of a finger; and the time, or a rate. Units that no column names are judged by
/// the first rows. Rates, accelerations and quaternions are no places. Empty: nothing may be an
/// axis, or nothing lacks.
[[nodiscard]] std::string exampleOfMap(const MotionHead& all);

}  // namespace wholehand
