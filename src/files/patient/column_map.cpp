#include "files/patient/column_map.hpp"

#include "files/patient/column_name.hpp"
#include "files/patient/csv_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>
#include <system_error>
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
  constexpr std::array<std::string_view, 26> kWords = {
      "gyro", "acc",    "mag",   "quat",   "rot",   "orient", "euler", "angle", "angular",
      "vel",  "torque", "force", "pixel",  "roll",  "pitch",  "yaw",   "phi",   "speed",
      "inch", "feet",   "norm",  "direct", "omega", "grav",   "size",  "scale"};
  const bool has_unit = text.find_first_of("([") != text.npos;
  if (has_unit && name.unit == nullptr) return true;
  const std::string stem = lower(name.stem);
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return stem.find(word) != stem.npos; });
}

/// True if names differ in one letter alone: x, y, z of "Wrist X", "px [m]", "x0".
bool differInAxis(const std::string& x, const std::string& other, char axis) {
  if (x.size() != other.size()) return false;
  std::size_t at = x.size(), differ = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i] != other[i]) at = i, ++differ;
  }
  const auto letter = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return differ == 1 && letter(x[at]) == 'x' && letter(other[at]) == axis;
}

/// True for the scalar part of the quaternion whose x is named, or a plain "W".
bool isScalarPart(const std::string& x, const std::string& text) {
  return differInAxis(x, text, 'w') || differInAxis(x, text, '0') || lower(text) == "w";
}

/// True for "qx", "palm_Qx": a part of a quaternion.
bool isOfQuaternion(const std::string& x, const std::string& y) {
  const auto at = static_cast<std::size_t>(
      std::mismatch(x.begin(), x.end(), y.begin(), y.end()).first - x.begin());
  const auto is_letter = [&](std::size_t i) {
    return std::isalpha(static_cast<unsigned char>(x[i])) != 0;
  };
  return at > 0 && lower(x)[at - 1] == 'q' && (at == 1 || !is_letter(at - 2));
}

/// True for three columns that may be a place.
bool isPlace(const std::vector<std::string>& names, std::size_t first) {
  if (first + 2 >= names.size()) return false;
  const std::string& x = names[first];
  if (!differInAxis(x, names[first + 1], 'y') || !differInAxis(x, names[first + 2], 'z')) {
    return false;
  }
  // Beside a w they are parts of a quaternion.
  if ((first > 0 && isScalarPart(x, names[first - 1])) ||
      (first + 3 < names.size() && isScalarPart(x, names[first + 3]))) {
    return false;
  }
  if (isOfQuaternion(x, names[first + 1])) return false;
  const ColumnName name = nameOf(x);
  if (name.unit != nullptr && name.unit->of != ColumnUnit::Of::kLength) return false;
  return !isOtherQuantity(x, name);
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

/// A name as the left side of an entry, without its unit in brackets.
std::string leftSide(const std::string& text) {
  const std::string name = withoutUnit(text);
  return name.find(',') != name.npos ? "\"" + name + "\"" : name;
}

std::optional<double> numberAt(const MotionHead& head, std::size_t row, std::size_t column) {
  if (row >= head.rows.size() || head.rows[row].size() != head.names.size()) return std::nullopt;
  const std::string& text = head.rows[row][column].text;
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// True if numbers stand in these columns, and none is larger than `most`.
bool within(const MotionHead& head, std::size_t first, std::size_t count, double most) {
  bool any = false;
  for (std::size_t row = 0; row < head.rows.size(); ++row) {
    for (std::size_t i = first; i < first + count; ++i) {
      const std::optional<double> value = numberAt(head, row, i);
      if (value && std::abs(*value) > most) return false;
      any = any || value;
    }
  }
  return any;
}

/// The unit that an entry has to name, judged by the first rows; empty: the column names it.
std::string unitOf(const MotionHead& head, std::size_t first, std::size_t count, bool length) {
  // A hand is measured within some metres; degrees are rarely as few as a right angle's radians.
  constexpr double kMost_m = 2.5, kMost_rad = 1.6;
  if (nameOf(head.names[first]).unit != nullptr) return {};
  const bool si = within(head, first, count, length ? kMost_m : kMost_rad);
  return length ? (si ? "_m" : "_mm") : (si ? "_rad" : "_deg");
}

/// True for a text with one of the words of a hand's place.
bool isOfHand(const std::string& text) {
  constexpr std::array<std::string_view, 3> kHand = {"hand", "palm", "wrist"};
  const std::string name = lower(text);
  return std::any_of(kHand.begin(), kHand.end(),
                     [&](std::string_view word) { return name.find(word) != name.npos; });
}

/// The first of three columns of the hand's place, else of any place.
std::optional<std::size_t> likeliestPlace(const std::vector<std::string>& names) {
  std::optional<std::size_t> found;
  for (std::size_t first = 0; first < names.size(); ++first) {
    if (!isPlace(names, first)) continue;
    if (isOfHand(names[first])) return first;
    if (!found) found = first;
  }
  return found;
}

/// Entries of a place, else of axes without a unit, else of the last angle of a finger.
std::vector<std::string> axisEntries(const MotionHead& head) {
  constexpr std::string_view kAxes = "xyz";
  const std::vector<std::string>& names = head.names;
  std::vector<std::string> entries;
  const auto add = [&](std::size_t i, std::string_view axis, const std::string& unit) {
    entries.push_back(fmt::format("{} = {}{}", leftSide(names[i]), axis, unit));
  };
  if (const std::optional<std::size_t> first = likeliestPlace(names)) {
    const std::string unit = unitOf(head, *first, kAxes.size(), true);
    for (std::size_t i = 0; i < kAxes.size(); ++i) add(*first + i, kAxes.substr(i, 1), unit);
    if (!head.has_up) entries.emplace_back("up = y");
    return entries;
  }
  for (const auto& [column, slides] : head.bare) {
    add(column, names[column], unitOf(head, column, 1, slides));
  }
  if (!entries.empty()) return entries;
  const auto angle = std::find_if(names.rbegin(), names.rend(), isAngle);
  if (angle == names.rend()) return {};
  const std::size_t last = static_cast<std::size_t>(names.rend() - angle) - 1;
  add(last, "finger_flexion", unitOf(head, last, 1, false));
  return entries;
}

/// How surely a column is the time of its row; 0: it is not.
int likenessToTime(const std::string& text) {
  const ColumnName name = nameOf(text);
  if (isTime(name.stem)) return 3;
  if (name.unit != nullptr) return name.unit->of == ColumnUnit::Of::kTime ? 2 : 0;
  const std::string stem = lower(name.stem);
  return stem.find("time") != stem.npos || stem.find("stamp") != stem.npos ? 1 : 0;
}

/// Entry of the time: of a column whose numbers increase, else a rate.
std::string timeEntry(const MotionHead& head) {
  // Units by which rows come at 5 Hz to 5 kHz.
  constexpr double kLeast_s = 2e-4, kMost_s = 0.2;
  constexpr std::array<std::pair<const char*, double>, 4> kUnits = {
      {{"_s", 1.0}, {"_ms", 1e-3}, {"_us", 1e-6}, {"_ns", 1e-9}}};
  for (int likeness = 3; likeness > 0; --likeness) {
    for (std::size_t i = 0; i < head.names.size(); ++i) {
      if (likenessToTime(head.names[i]) != likeness) continue;
      const auto first = numberAt(head, 0, i), second = numberAt(head, 1, i);
      if (!first || !second || !(*second > *first)) continue;
      if (nameOf(head.names[i]).unit != nullptr) return leftSide(head.names[i]) + " = time";
      const auto* const unit = std::find_if(kUnits.begin(), kUnits.end(), [&](const auto& u) {
        const double step_s = (*second - *first) * u.second;
        return step_s >= kLeast_s && step_s < kMost_s;
      });
      return leftSide(head.names[i]) + " = time" + (unit != kUnits.end() ? unit->first : "_s");
    }
  }
  return "rate_hz = 120";
}

using Rows = std::vector<std::vector<Cell>>;

/// Rows of the first two frames, told apart by a column; empty: it numbers each row.
std::array<Rows, 2> firstFrames(const MotionHead& head, std::size_t column) {
  std::array<Rows, 2> frames;
  std::size_t frame = 0;
  for (const std::vector<Cell>& row : head.rows) {
    if (row.size() != head.names.size()) return {};
    if (!frames[frame].empty() && row[column].text != frames[frame].back()[column].text) ++frame;
    if (frame == frames.size()) break;
    frames[frame].push_back(row);
  }
  return frames[0].size() > 1 && !frames[1].empty() ? frames : std::array<Rows, 2>{};
}

std::set<std::string> valuesIn(const Rows& rows, std::size_t column) {
  std::set<std::string> values;
  for (const std::vector<Cell>& row : rows) values.insert(row[column].text);
  return values;
}

/// True for the name of a column that may tell parts of a hand apart.
bool mayNumberParts(const std::string& text) {
  constexpr std::array<std::string_view, 12> kWords = {"landmark", "joint", "bone",  "hand",
                                                       "marker",   "part",  "point", "finger",
                                                       "segment",  "label", "name",  "id"};
  const std::string name = lower(text);
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](std::string_view word) { return name.find(word) != name.npos; });
}

/// True for a column that numbers the parts of each frame: no value has a point, and the second
/// frame, which may be cut off, has no other ones.
bool numbersParts(const std::array<Rows, 2>& frames, std::size_t column) {
  const std::set<std::string> values = valuesIn(frames[0], column),
                              again = valuesIn(frames[1], column);
  const bool whole = std::none_of(values.begin(), values.end(), [](const std::string& value) {
    return value.empty() || value.find('.') != value.npos;
  });
  return whole && values.size() > 1 &&
         std::includes(values.begin(), values.end(), again.begin(), again.end());
}

}  // namespace

std::map<std::string, std::string> partsOfFrame(const MotionHead& head) {
  for (std::size_t i = 0; i < head.names.size(); ++i) {
    const bool counts = lower(head.names[i]).find("frame") != std::string::npos;
    if (!counts && likenessToTime(head.names[i]) == 0) continue;
    const std::array<Rows, 2> frames = firstFrames(head, i);
    if (frames[0].empty()) continue;
    std::map<std::string, std::string> parts;
    Rows left = frames[0];
    for (std::size_t k = 0; k < head.names.size(); ++k) {
      if (k == i || !mayNumberParts(head.names[k]) || !numbersParts(frames, k)) continue;
      const auto of_hand =
          std::find_if(left.begin(), left.end(),
                       [&](const std::vector<Cell>& row) { return isOfHand(row[k].text); });
      const std::string value = (of_hand != left.end() ? *of_hand : left.front())[k].text;
      parts[head.names[k]] = value;
      std::erase_if(left, [&](const std::vector<Cell>& row) { return row[k].text != value; });
      if (left.size() == 1) return parts;
    }
  }
  return {};
}

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
    } else if (constexpr std::string_view kOnly = "only "; value.starts_with(kOnly)) {
      map.only[name] = trimmed(std::string_view(value).substr(kOnly.size()));
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

std::string exampleOfMap(const MotionHead& all) {
  MotionHead head = all;
  std::vector<std::string> entries, only;
  for (const auto& part : partsOfFrame(all)) {
    const auto column = static_cast<std::size_t>(
        std::find(all.names.begin(), all.names.end(), part.first) - all.names.begin());
    only.push_back(fmt::format("{} = only {}", leftSide(part.first), part.second));
    std::erase_if(head.rows, [&](const std::vector<Cell>& row) {
      return row.size() <= column || row[column].text != part.second;
    });
  }
  if (!head.has_axis) entries = axisEntries(head);
  if (!head.has_axis && entries.empty()) return {};
  entries.insert(entries.end(), only.begin(), only.end());
  if (!head.has_time) entries.push_back(timeEntry(head));
  return entries.empty() ? "" : fmt::format("{} {}", kBegin, fmt::join(entries, ", "));
}

}  // namespace wholehand
