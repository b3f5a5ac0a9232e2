#include "files/patient/column_name.hpp"

#include "files/patient/csv_line.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>

namespace wholehand {
namespace {

constexpr std::array kUnits = {ColumnUnit{"s", ColumnUnit::Of::kTime, 1.0},
                               ColumnUnit{"sec", ColumnUnit::Of::kTime, 1.0},
                               ColumnUnit{"ms", ColumnUnit::Of::kTime, 1e-3},
                               ColumnUnit{"msec", ColumnUnit::Of::kTime, 1e-3},
                               ColumnUnit{"us", ColumnUnit::Of::kTime, 1e-6},
                               ColumnUnit{"usec", ColumnUnit::Of::kTime, 1e-6},
                               ColumnUnit{"ns", ColumnUnit::Of::kTime, 1e-9},
                               ColumnUnit{"m", ColumnUnit::Of::kLength, 1.0},
                               ColumnUnit{"cm", ColumnUnit::Of::kLength, 1e-2},
                               ColumnUnit{"mm", ColumnUnit::Of::kLength, 1e-3},
                               ColumnUnit{"rad", ColumnUnit::Of::kAngle, 1.0},
                               ColumnUnit{"deg", ColumnUnit::Of::kAngle, std::numbers::pi / 180.0}};

}  // namespace

ColumnName nameOf(std::string_view text) {
  ColumnName name;
  std::string unit;
  const std::size_t bracket = text.find_first_of("([");
  if (bracket != text.npos && bracket > 0) {
    unit = text.substr(bracket + 1, text.find_first_of(")]", bracket) - bracket - 1);
    name.stem = trimmed(text.substr(0, bracket));
  } else if (const std::size_t line = text.rfind('_'); line != text.npos) {
    unit = text.substr(line + 1);
    name.stem = text.substr(0, line);
  } else {
    name.stem = text;
  }
  name.foreign = bracket != text.npos;
  for (char& c : name.stem) {
    if (c >= 'A' && c <= 'Z') name.foreign = true, c = static_cast<char>(c - 'A' + 'a');
    if (c == ' ') c = '_';
  }
  const auto* const at = std::find_if(kUnits.begin(), kUnits.end(),
                                      [&](const ColumnUnit& u) { return u.name == unit; });
  if (at != kUnits.end()) name.unit = &*at;
  if (name.unit == nullptr && bracket == text.npos) name.stem = text;
  return name;
}

bool isTime(std::string_view stem) {
  constexpr std::array<std::string_view, 6> kNames = {"time",  "t",      "timestamp",
                                                      "%time", "__time", "stamp"};
  return std::find(kNames.begin(), kNames.end(), stem) != kNames.end();
}

}  // namespace wholehand
