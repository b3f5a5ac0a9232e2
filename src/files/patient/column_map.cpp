#include "files/patient/column_map.hpp"

#include "files/patient/column_name.hpp"
#include "files/patient/csv_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <utility>

namespace wholehand {
namespace {

constexpr std::string_view kBegin = "# columns:";
constexpr double kMostRate_hz = 1e5;

/// "Wrist X (mm)" without its unit.
std::string withoutUnit(const std::string& text) {
  return text.substr(0, text.rfind(" ("));
}

/// A text in lower case.
std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// True for the name of a quantity that is no place: a map that reads it as one would play.
bool isOtherQuantity(const std::string& text, const ColumnName& name) {
  constexpr std::array<std::string_view, 18> kWords = {
      "gyro", "acc",    "mag",   "quat",  "rot",  "orient", "euler", "angle", "angular",
      "vel",  "torque", "force", "pixel", "roll", "pitch",  "yaw",   "phi",   "speed"};
  const bool has_unit = text.find_first_of("([") != text.npos;
  if (has_unit && name.unit == nullptr) return true;
  const std::string stem = lower(name.stem);
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return stem.find(word) != stem.npos; });
}

/// True for "Wrist X" as x, if it may be a place.
bool isPosition(const std::string& text, char axis) {
  const ColumnName name = nameOf(text);
  if (name.unit != nullptr && name.unit->of != ColumnUnit::Of::kLength) return false;
  const bool of_axis = !name.stem.empty() && lower(name.stem).back() == axis;  // "Wrist X", too
  return of_axis && !isOtherQuantity(text, name);
}

/// True for a name that may be the angle of a finger.
bool isAngle(const std::string& text) {
  const ColumnName name = nameOf(text);
  if (name.unit != nullptr) return name.unit->of == ColumnUnit::Of::kAngle;
  if (text.find_first_of("([") != text.npos) return false;
  constexpr std::array<std::string_view, 8> kWords = {"theta",  "flex",  "angle", "bend",
                                                      "finger", "thumb", "pip",   "mcp"};
  const std::string stem = lower(name.stem);
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return stem.find(word) != stem.npos; });
}

}  // namespace

bool isColumnMap(std::string_view line) {
  return line.starts_with(kBegin);
}

Diagnostics readColumnMap(std::string_view line, ColumnMap& map) {
  Diagnostics faults;
  const auto fail = [&](const std::string& value, std::string problem, std::string remedy) {
    faults.push_back({"", 0, "# columns", shown(value), std::move(problem), std::move(remedy)});
  };
  for (const Cell& cell : cells(line.substr(kBegin.size()))) {
    const std::size_t sign = cell.text.rfind('=');
    const std::string name(trimmed(cell.text.substr(0, sign)));
    const std::string value(sign == cell.text.npos ? "" : trimmed(cell.text.substr(sign + 1)));
    if (name.empty() || value.empty()) {
      fail(cell.text, "says nothing of a column", "write a name of the motion = x_mm, ...");
    } else if (name == "up") {
      map.up = value.front();
      if (value != "y" && value != "z") {
        fail(cell.text, "is no axis that may point up", "write up = y or up = z");
      }
    } else if (name == "rate_hz") {
      const auto [end, error] =
          std::from_chars(value.data(), value.data() + value.size(), map.rate_hz);
      const bool whole = error == std::errc() && end == value.data() + value.size();
      if (!whole || !(map.rate_hz > 0.0 && map.rate_hz <= kMostRate_hz)) {
        fail(cell.text, "is no rate", "must be in (0, 100000] Hz");
      }
    } else if (!map.columns.emplace(name, value).second) {
      fail(cell.text, "names this column twice", "name it once");
    }
  }
  return faults;
}

std::string takeName(ColumnMap& map, const std::string& text) {
  const ColumnUnit* const unit = nameOf(text).unit;
  auto found = map.columns.find(text);
  if (found == map.columns.end()) found = map.columns.find(withoutUnit(text));
  if (found == map.columns.end()) return text;
  std::string name = std::move(found->second);
  map.columns.erase(found);
  if (unit != nullptr && nameOf(name).unit == nullptr) name += "_" + std::string(unit->name);
  return name;
}

std::string exampleOfMap(const std::vector<std::string>& names, bool has_time) {
  constexpr std::string_view kAxes = "xyz";
  std::size_t first = 0;
  const auto is_place = [&](std::size_t i) {
    // Beside a w they are parts of a quaternion.
    const bool turns = (i > 0 && isPosition(names[i - 1], 'w')) ||
                       (i + 3 < names.size() && isPosition(names[i + 3], 'w'));
    return !turns && isPosition(names[i], 'x') && isPosition(names[i + 1], 'y') &&
           isPosition(names[i + 2], 'z');
  };
  while (first + 2 < names.size() && !is_place(first)) ++first;
  const bool place = first + 2 < names.size();
  if (!place) {
    const auto angle = std::find_if(names.rbegin(), names.rend(), isAngle);
    if (angle == names.rend()) return {};
    first = static_cast<std::size_t>(names.rend() - angle) - 1;
  }
  std::string line = std::string(kBegin);
  for (std::size_t i = 0; i < (place ? kAxes.size() : 1); ++i) {
    const std::string name = withoutUnit(names[first + i]);
    const bool quoted = name.find(',') != name.npos;
    const bool has_unit = nameOf(names[first + i]).unit != nullptr;
    line += fmt::format("{} {} = {}{}", i == 0 ? "" : ",", quoted ? "\"" + name + "\"" : name,
                        place ? kAxes.substr(i, 1) : "finger_flexion",
                        has_unit ? ""
                        : place  ? "_mm"
                                 : "_deg");
  }
  if (place) line += ", up = y";
  return has_time ? line : line + ", rate_hz = 120";
}

}  // namespace wholehand
