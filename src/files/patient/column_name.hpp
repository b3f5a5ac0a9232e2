#pragma once

#include <string>
#include <string_view>

namespace wholehand {

/// A unit that the name of a column may give, and what it is of.
struct ColumnUnit {
  enum class Of { kTime, kLength, kAngle };
  std::string_view name;
  Of of = Of::kTime;
  double factor = 1.0;  ///< to s, m or rad
};

/// What a column's name says: "x_mm", "X (mm)" and "X [mm]" are x in mm.
struct ColumnName {
  std::string stem;
  const ColumnUnit* unit = nullptr;  ///< nullptr: it gives none of these
  bool foreign = false;              ///< of another program: in brackets, or with capital letters
};

[[nodiscard]] ColumnName nameOf(std::string_view text);

/// True for the names that other programs give to the time.
[[nodiscard]] bool isTime(std::string_view stem);

}  // namespace wholehand
