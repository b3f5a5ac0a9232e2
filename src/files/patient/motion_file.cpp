#include "files/patient/motion_file.hpp"

#include "files/device/axis_keys.hpp"
#include "files/foreign/foreign_file.hpp"
#include "files/patient/column_map.hpp"
#include "files/patient/column_name.hpp"
#include "files/patient/csv_line.hpp"
#include "files/patient/mocap_head.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace wholehand {

namespace {

/// "1 value", "2 values"
std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

constexpr std::size_t kMostFaults = 20;
constexpr double kLargestValue = 1000.0;  // m or rad: beyond any hand motion
constexpr double kLongest_s = 3600.0;
constexpr const char* kGiveMotion =
    "give a CSV file whose first line names the columns: time_s, x_m, ...";

bool isOfMotion(std::string_view text) {
  const ColumnName name = nameOf(text);
  return name.unit != nullptr || isTime(name.stem);
}

/// True for a header that blanks divide.
bool isDividedByBlanks(const std::vector<Cell>& names) {
  if (names.size() != 1) return false;
  const std::string& text = names.front().text;
  const std::size_t blank = text.find(' ');
  return blank != text.npos && isOfMotion(text.substr(0, blank));
}

/// Reason why a first line is not the header of a motion file; empty if it is one.
std::string noHeader(const std::vector<Cell>& names) {
  const bool any = std::any_of(names.begin(), names.end(),
                               [](const Cell& cell) { return isOfMotion(cell.text); });
  return any ? "" : "is not a motion: its first line names neither a time nor an axis";
}

/// True for a first line that names columns of another program: words between separators.
bool mayBeMapped(const std::vector<Cell>& names) {
  constexpr std::size_t kFewest = 3;
  return names.size() >= kFewest && std::none_of(names.begin(), names.end(), [](const Cell& cell) {
           return !cell.text.empty() &&
                  cell.text.find_first_not_of("+-.,0123456789eE") == std::string::npos;
         });
}

/// True for "#timestamp [ns],x [m],...": names of columns after the sign of a comment.
bool isNamesAfterSign(std::string_view text) {
  if (!text.starts_with('#')) return false;
  const std::vector<Cell> names = cells(text.substr(1), separatorOf(text));
  const ColumnName first = nameOf(names.front().text);
  return mayBeMapped(names) && isTime(first.stem) && (first.unit != nullptr || text[1] != ' ');
}

/// True for a cell of a marker or hand that was not seen.
bool isUnseen(std::string_view cell) {
  return cell.empty() || cell == "nan" || cell == "NaN" || cell == "NAN";
}

std::string orWrite(const std::string& line) {
  return line.empty() ? "" : "; or write before the names, with your names and units: " + line;
}

/// Kind of the device's axis of that name, else of the standard axis of that name.
std::optional<AxisKind> kindOf(std::string_view name, const DeviceModel* device) {
  if (device != nullptr) {
    for (const DeviceAxis& axis : device->axes) {
      if (axis.name == name) return axis.kind;
    }
  }
  return knownAxisKind(name);
}

std::string axisNames(const DeviceModel* device) {
  std::string names;
  for (const KnownAxis& axis : kKnownAxes) {
    names += (names.empty() ? "" : ", ") + std::string(axis.name);
  }
  if (device == nullptr) return names;
  for (const DeviceAxis& axis : device->axes) {
    if (kindOf(axis.name, nullptr)) continue;
    names += ", " + axis.name;
  }
  return names;
}

/// Reads one file line by line and collects every fault.
class Reader {
 public:
  Reader(const std::string& path, const DeviceModel* device) : device_(device) {
    motion_.path = path;
  }

  Expected<MotionFile> read();

 private:
  /// Reads one line. Returns false when the file is not a motion file and further faults would be
  /// noise.
  bool line(std::string_view text);
  void header(const std::vector<Cell>& names);
  void readEarlyRows();
  void checkColumns();
  void checkMap();
  void column(const std::string& text, std::size_t place);
  void timeColumn(const ColumnName& name, const std::string& text, std::size_t place);
  void readComment(std::string_view comment);
  void checkUp();
  void row(std::string_view line);
  /// Values of a line, by what divides the file's columns.
  [[nodiscard]] std::vector<Cell> valuesOf(std::string_view text) const;
  /// A number as it is read: with a decimal point, unless commas divide the columns.
  [[nodiscard]] std::string numeral(std::string cell) const;
  std::optional<double> number(const std::string& written, std::size_t place);
  void checkDecimals();
  void checkTime(double time_s, std::string_view cell);
  /// Refuses a file that is not a motion file. If its format is known, the message names it.
  void refuse(const std::string& problem, const char* remedy = kGiveMotion);
  void turnUp(std::vector<double>& sample) const;
  void checkWhole();
  Expected<MotionFile> finish();
  void checkValues();
  void checkPace();
  void fault(std::string key, std::string_view value, std::string problem, std::string remedy);
  /// Adds a fault, up to kMostFaults of them.
  void keep(Diagnostic fault);

  const DeviceModel* device_;
  ColumnMap map_;
  MocapHead mocap_;
  MotionFile motion_;
  Diagnostics faults_;
  Diagnostics ignored_;         // notices of ignored columns
  bool other_section_ = false;  // a section before the motion is skipped
  std::size_t unreported_ = 0;
  std::size_t incomplete_ = 0;  // rows without a value that is read, left out
  int line_ = 0;
  char separator_ = 0;                         // of columns; 0: no line with one yet
  int decimal_comma_ = 0, decimal_point_ = 0;  // the first line with either; 0: none
  std::vector<std::string> header_;            // the columns as written
  std::vector<double> factor_;                 // for each column, to s, m or rad; 0: it is not read
  std::vector<bool> foreign_;  // for each axis column: named in another program's way
  std::optional<std::size_t> time_place_;
  std::size_t unnamed_ = 0;  // number of values in a row before those that the header names
  std::vector<int> lines_;   // line of each sample
  std::vector<std::string> unmapped_;  // columns that are no axis, as written
  // Columns that have the name of an axis and no unit; true: a translation.
  std::vector<std::pair<std::size_t, bool>> bare_;
  // The header is judged together with the first rows, which are kept until then.
  static constexpr std::size_t kEarlyRows = 50;
  bool judged_ = false;
  int header_line_ = 0;
  std::vector<std::pair<int, std::string>> early_;         // line and text
  std::vector<std::pair<std::size_t, std::string>> only_;  // place, and text of rows that are read
  bool mapped_ = false;                                    // the column has its name from the map
  bool of_other_program_ = false;  // names or head are: cells may be empty or too few
  int rows_ = 0;
};

void Reader::fault(std::string key, std::string_view value, std::string problem,
                   std::string remedy) {
  keep({motion_.path, line_, std::move(key), shown(value), std::move(problem), std::move(remedy)});
}

void Reader::keep(Diagnostic fault) {
  if (faults_.size() == kMostFaults) {
    ++unreported_;
  } else {
    faults_.push_back(std::move(fault));
  }
}

void Reader::refuse(const std::string& problem, const char* remedy) {
  if (const auto foreign = foreignFileAt(motion_.path)) {
    fault("", "", foreign->problem, foreign->remedy);
  } else if (const auto kind = fileKind(motion_.path)) {
    fault("", "", "is a file of kind \"" + printable(*kind) + "\"", kGiveMotion);
  } else {
    fault("", "", problem, remedy);
  }
}

void Reader::timeColumn(const ColumnName& name, const std::string& text, std::size_t place) {
  if (name.unit == nullptr) return;  // header() names it if there is no other
  if (name.unit->of != ColumnUnit::Of::kTime) {
    return fault("column " + std::to_string(place + 1), text, "is a time in the unit of another",
                 "name it time_s, or with ms, us or ns");
  }
  if (time_place_ && text != "time_s") return;
  if (time_place_) factor_[*time_place_] = 0.0;
  time_place_ = place;
  factor_[place] = name.unit->factor;
}

void Reader::column(const std::string& text, std::size_t place) {
  const std::string key = "column " + std::to_string(place + 1);
  if (text.empty() && (place == 0 || of_other_program_)) return;  // pandas, R: row numbers
  if (text.empty()) {
    fault(key, text, "has no name", "name it time_s, <axis>_m or <axis>_rad");
    return;
  }
  const ColumnName name = nameOf(text);
  const bool twice = std::find(header_.begin(), header_.end() - 1, text) != header_.end() - 1;
  if (isTime(name.stem) && !twice) return timeColumn(name, text, place);
  const std::string axis = name.unit != nullptr || name.stem.find('_') == name.stem.npos
                               ? name.stem
                               : name.stem.substr(0, name.stem.rfind('_'));
  std::optional<AxisKind> kind = kindOf(axis, device_);
  if (!kind && name.unit == nullptr) kind = kindOf(name.stem, device_);
  constexpr const char* kUnitRemedy =
      "end it in _m, _cm or _mm for a translation, _rad or _deg for a rotation";
  if (!kind || (name.unit == nullptr && of_other_program_ && !mapped_)) {
    unmapped_.push_back(text);
    const bool known = name.unit != nullptr;
    ignored_.push_back({motion_.path, line_, key, shown(text),
                        known ? "is no known axis" : "has no known unit",
                        known ? "use one of " + axisNames(device_) : kUnitRemedy});
    return;
  }
  const bool slides = *kind == AxisKind::kTranslation;
  if (twice) {
    fault(key, text, "stands there twice", "keep one of the two columns");
  } else if (name.unit == nullptr) {
    bare_.emplace_back(place, slides);
    fault(key, text, "has no known unit", kUnitRemedy);
  } else if (name.unit->of != (slides ? ColumnUnit::Of::kLength : ColumnUnit::Of::kAngle)) {
    fault(key, text, "has the wrong unit",
          axis + (slides ? " is a translation: use _m" : " is a rotation: use _rad"));
  } else if (std::find(motion_.columns.begin(), motion_.columns.end(), axis) !=
             motion_.columns.end()) {
    fault(key, text, "is the axis " + axis + " once more", "keep one of the two columns");
  } else {
    motion_.columns.push_back(axis);
    foreign_.push_back(name.foreign);
    factor_[place] = name.unit->factor;
  }
}

/// Reads a line "# up = y" or "# columns: ...".
void Reader::readComment(std::string_view comment) {
  if (isColumnMap(comment)) {
    for (Diagnostic& entry : readColumnMap(comment, map_)) {
      fault(std::move(entry.key), entry.value, std::move(entry.problem), std::move(entry.remedy));
    }
    return;
  }
  std::string words;
  for (const char c : comment) {
    if (c != ' ' && c != '\t') words += c;
  }
  if (!words.starts_with("#up=")) return;
  map_.up = words == "#up=y" ? 'y' : 'z';
  if (words == "#up=y" || words == "#up=z") return;
  fault("# up", words.substr(4), "is no axis that may point up",
        "write \"# up = y\" or \"# up = z\"");
}

/// A position in columns of another program may have y up. Motions are fitted to the device, so a
/// wrong axis would pass unseen: such a file must say which axis points up.
void Reader::checkUp() {
  const auto at = [&](const char* name) {
    return std::find(motion_.columns.begin(), motion_.columns.end(), name) -
           motion_.columns.begin();
  };
  const auto none = static_cast<std::ptrdiff_t>(motion_.columns.size());
  const std::ptrdiff_t y = at("y"), z = at("z");
  if (map_.up == 0 && y < none && z < none && (foreign_[y] || foreign_[z])) {
    fault("", "", "does not say which of its axes points up",
          "put the line \"# up = y\" or \"# up = z\" before the names of the columns");
  }
  if (map_.up != 'y') return;
  if (y == none || z == none) {
    fault("# up", "y", "needs both columns, y and z", "give both, or take the line out");
  }
}

void Reader::header(const std::vector<Cell>& names) {
  header_line_ = line_;
  of_other_program_ = mocap_.begun() || !map_.columns.empty();
  for (const auto& only : map_.only) {
    const auto at = std::find_if(names.begin(), names.end(),
                                 [&](const Cell& cell) { return cell.text == only.first; });
    if (at == names.end()) {
      fault("# columns", only.first + " = only " + only.second, "names no column of the motion",
            "give a name as the motion has it");
    } else {
      only_.emplace_back(at - names.begin(), only.second);
    }
  }
  // Reads the columns and finds the time.
  factor_.resize(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name = takeName(map_, names[i].text);
    mapped_ = name != names[i].text;
    header_.push_back(name);
    const std::size_t axes = motion_.columns.size();
    const bool rest = std::all_of(names.begin() + static_cast<std::ptrdiff_t>(i), names.end(),
                                  [](const Cell& cell) { return cell.text.empty(); });
    if (!rest) column(name, i);
    if (mapped_ && motion_.columns.size() > axes) foreign_.back() = true;
  }
  if (mocap_.rate_hz() > 0.0 && !time_place_) {
    time_place_ = 0;  // the frame's number
    factor_[0] = 1.0 / mocap_.rate_hz();
  }
}

/// Judges the header, and reads the rows that were kept for this.
void Reader::readEarlyRows() {
  if (judged_ || header_.empty()) return;
  judged_ = true;
  const int line = std::exchange(line_, header_line_);
  checkMap();
  checkColumns();
  for (const auto& [at, text] : std::exchange(early_, {})) {
    line_ = at;
    row(text);
  }
  line_ = line;
}

/// Reports names of the column map that the motion does not have.
void Reader::checkMap() {
  for (const auto& [name, column] : map_.columns) {
    fault("# columns", name + " = " + column, "names no column of the motion",
          "give a name as the motion has it");
  }
}

void Reader::checkColumns() {
  const bool none = motion_.columns.empty();
  const auto other = std::find_if(header_.begin(), header_.end(), [](const std::string& text) {
    return isTime(nameOf(text).stem);
  });
  MotionHead head{header_, {}, !none, time_place_ || map_.rate_hz > 0.0, map_.up != 0, bare_};
  for (const auto& early : early_) {
    head.rows.push_back(valuesOf(early.second));
    for (Cell& cell : head.rows.back()) cell.text = numeral(std::move(cell.text));
  }
  const std::string line = exampleOfMap(head);
  if (none && faults_.empty() && unmapped_.size() > 1) {
    fault("", "",
          fmt::format("names {} and no known axis: \"{}\", \"{}\"{}",
                      counted(unmapped_.size(), "column"), shown(unmapped_[0]), shown(unmapped_[1]),
                      unmapped_.size() > 2 ? ", ..." : ""),
          line.empty()
              ? "none is named as a place or an angle of a finger; if one is, write before "
                "its first line, with its name and unit: # columns: NAME = x_mm"
              : "write before its first line, with your names, units and rate: " + line);
    return;
  }
  if (time_place_ && map_.rate_hz > 0.0) {
    fault("# columns", fmt::format("rate_hz = {:g}", map_.rate_hz),
          "stands beside a time: the column " + shown(header_[*time_place_]),
          "take the rate out, or name the column otherwise");
  }
  // With a time, such rows are refused since it does not increase.
  if (const auto parts = partsOfFrame(head);
      !parts.empty() && only_.empty() && !time_place_ && map_.rate_hz > 0.0) {
    const auto& [name, value] = *parts.begin();
    fault("# columns", fmt::format("rate_hz = {:g}", map_.rate_hz),
          fmt::format("is given where each frame has several rows, by the column {}", shown(name)),
          fmt::format("keep those of one, e.g. {} = only {}", shown(name), shown(value)));
  }
  if (!time_place_ && map_.rate_hz == 0.0) {
    fault("time_s", "",
          other == header_.end()
              ? "is missing"
              : "is missing: the column " + shown(*other) + " does not say its unit",
          "name the time of each row with its unit: time_s, time_ms, time_us or time_ns" +
              (bare_.empty() ? orWrite(line) : ""));
  }
  if (!bare_.empty() && !faults_.empty()) faults_.back().remedy += orWrite(line);
  for (std::size_t i = 0; i < header_.size(); ++i) {
    if (factor_[i] == 0.0 || factor_[i] == 1.0 || (i == time_place_ && mocap_.begun())) continue;
    motion_.notices.push_back(
        {motion_.path, line_, "column " + std::to_string(i + 1), shown(header_[i]),
         fmt::format("is converted: its values times {:.6g}", factor_[i]), "nothing to do"});
  }
  checkUp();
  // Ignored columns are faults if no axis column exists, else notices.
  for (Diagnostic& column : ignored_) {
    if (none) {
      keep(std::move(column));
    } else if (motion_.notices.size() < kMostFaults) {
      column.problem += " and is ignored";
      motion_.notices.push_back(std::move(column));
    }
  }
  if (!none && ignored_.size() > kMostFaults) {
    const std::size_t more = ignored_.size() - kMostFaults;
    motion_.notices.push_back({motion_.path, line_, "", "",
                               "has " + counted(more, "more column") + " that no axis has, ignored",
                               "name those that shall move in _m or _rad"});
  }
  if (faults_.empty() && none) {
    fault("", "", "has no axis column", "add a column such as x_m or finger_flexion_rad");
  }
}

bool Reader::line(std::string_view text) {
  // Byte order mark of UTF-16.
  const bool marked = text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
  if (marked || holdsControl(text)) {
    refuse("is not a CSV text: it holds bytes that no text has");
    return false;
  }
  if (!header_.empty()) {
    if (judged_) {
      row(text);
    } else {
      early_.emplace_back(line_, std::string(text));
      if (early_.size() == kEarlyRows) readEarlyRows();
    }
    return true;
  }
  if (separator_ == 0) separator_ = separatorOf(text);
  if (text.size() == 5 && text.starts_with("sep=")) {  // Excel's hint
    separator_ = text.back();
    return true;
  }
  const std::vector<Cell> names = valuesOf(text);
  other_section_ =
      (other_section_ || MocapHead::isOtherSection(names)) && !MocapHead::begins(names);
  if (other_section_) return true;
  if (mocap_.begun() || MocapHead::begins(names)) {
    if (!mocap_.add(names)) {
      refuse("begins as a file of motion capture, but its names do not stand where they should",
             "export it as CSV with its header");
      return false;
    }
    if (!mocap_.complete()) return true;
    std::vector<Cell> columns;
    for (std::string& name : mocap_.columns()) columns.push_back({std::move(name), false});
    header(columns);
    return true;
  }
  if (isDividedByBlanks(names)) {
    refuse("is not a CSV file: its columns are divided by blanks",
           "divide the columns by commas, semicolons or tabs");
    return false;
  }
  if (std::string why = noHeader(names);
      !why.empty() && map_.columns.empty() && !mayBeMapped(names)) {
    refuse(why);
    return false;
  }
  header(names);
  return true;
}

std::vector<Cell> Reader::valuesOf(std::string_view text) const {
  return cells(text, separator_ == 0 ? ',' : separator_);
}

std::string Reader::numeral(std::string cell) const {
  return separator_ == ',' ? cell : withPoint(std::move(cell));
}

std::optional<double> Reader::number(const std::string& written, std::size_t place) {
  const std::string& key = header_[place];
  const std::string cell = numeral(written);
  const bool comma = cell != written;
  if (comma && decimal_comma_ == 0) decimal_comma_ = line_;
  if (!comma && decimal_point_ == 0 && cell.find('.') != cell.npos) decimal_point_ = line_;
  double value = 0.0;
  // from_chars ignores the locale, unlike strtod, but accepts no leading plus.
  std::string_view digits = cell;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (cell.empty()) {
    fault(key, cell, "is empty", "write a number");
  } else if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) {
    fault(key, cell, "is not a number", "write a decimal number such as 0.125");
  } else if (error == std::errc::result_out_of_range || !std::isfinite(value)) {
    fault(key, cell, "is not finite", "write a finite number");
  } else if (place != time_place_ && std::abs(factor_[place] * value) > kLargestValue) {
    fault(key, cell, "is out of range", "must be in [-1000, 1000] m or rad");
  } else {
    return factor_[place] * value;
  }
  return std::nullopt;
}

void Reader::checkTime(double time_s, std::string_view cell) {
  if (!motion_.time_s.empty() && !(time_s > motion_.time_s.back())) {
    fault("time_s", cell, "does not increase", "each row's time must exceed the row's before");
  } else if (!motion_.time_s.empty() && time_s - motion_.time_s.front() > kLongest_s) {
    fault("time_s", cell, "is more than an hour after the first row", "must be within 3600 s");
  }
  motion_.time_s.push_back(time_s);
}

void Reader::row(std::string_view line) {
  ++rows_;
  std::vector<Cell> values = valuesOf(line);
  // Motion capture leaves out cells at the end of a row, or adds empty ones.
  const auto is_empty = [](const Cell& cell) { return cell.text.empty(); };
  if (of_other_program_ &&
      (values.size() < header_.size() ||
       std::all_of(values.begin() + static_cast<long>(header_.size()), values.end(), is_empty))) {
    values.resize(header_.size());
  }
  // R writes a quoted row number before each row and no header for it.
  if (rows_ == 1 && values.size() == header_.size() + 1 && values[0].quoted) unnamed_ = 1;
  if (values.size() != header_.size() + unnamed_) {
    fault("", "",
          "has " + counted(values.size(), "value") + ", the header names " +
              counted(header_.size(), "column"),
          "give every row one value a column");
    return;
  }
  const bool other_part = std::any_of(only_.begin(), only_.end(), [&](const auto& only) {
    return values[only.first + unnamed_].text != only.second;
  });
  if (other_part) {
    --rows_;
    return;
  }
  // Motion capture leaves cells empty while it does not see a marker.
  for (std::size_t i = 0; of_other_program_ && i < header_.size(); ++i) {
    if (factor_[i] == 0.0 || !isUnseen(values[i + unnamed_].text)) continue;
    ++incomplete_;
    return;
  }
  std::vector<double> sample;
  if (!time_place_ && map_.rate_hz > 0.0) {
    motion_.time_s.push_back(static_cast<double>(rows_ - 1) / map_.rate_hz);
  }
  for (std::size_t i = 0; i < header_.size(); ++i) {
    if (factor_[i] == 0.0) continue;
    const std::string& cell = values[i + unnamed_].text;
    const std::optional<double> value = number(cell, i);
    if (!value) continue;
    if (i == time_place_) {
      checkTime(*value, cell);
    } else {
      sample.push_back(*value);
    }
  }
  if (map_.up == 'y' && sample.size() == motion_.columns.size()) turnUp(sample);
  motion_.samples.push_back(std::move(sample));
  lines_.push_back(line_);
}

/// Turns a position with y up about x, so that z is up: (x, y, z) becomes (x, -z, y).
void Reader::turnUp(std::vector<double>& sample) const {
  const auto at = [&](const char* name) {
    return std::find(motion_.columns.begin(), motion_.columns.end(), name) -
           motion_.columns.begin();
  };
  const std::ptrdiff_t y_at = at("y"), z_at = at("z");
  const auto none = static_cast<std::ptrdiff_t>(motion_.columns.size());
  if (y_at == none || z_at == none) return;  // checkUp() refused the file
  double &y = sample[static_cast<std::size_t>(y_at)], &z = sample[static_cast<std::size_t>(z_at)];
  y = -std::exchange(z, y);
}

/// Reports values that no hand and no device reaches: they have another unit. Names the first one
/// of each column.
void Reader::checkValues() {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi, kMostTurn_rad = 2.0 * kTurn_rad;
  constexpr double kBeyond = 10.0;
  for (std::size_t c = 0; c < motion_.columns.size(); ++c) {
    const std::string& name = motion_.columns[c];
    const bool turns = kindOf(name, device_) == AxisKind::kRotation;
    const std::string key = name + (turns ? "_rad" : "_m");
    const int at = device_ != nullptr ? device_->axisIndex(name) : -1;
    const DeviceAxis axis = at >= 0 ? device_->axes[at] : DeviceAxis{};
    const double width = axis.upper - axis.lower;
    const double first = motion_.samples.front()[c];
    for (std::size_t i = 0; i < motion_.samples.size(); ++i) {
      line_ = lines_[i];
      const double value = motion_.samples[i][c];
      const double step = i > 0 ? std::abs(value - motion_.samples[i - 1][c]) : 0.0;
      const double step_s = i > 0 ? motion_.time_s[i] - motion_.time_s[i - 1] : 1.0;
      const std::string shown_value = fmt::format("{:g}", value);
      // Reports the first implausible value of the column.
      if (turns && std::abs(value) > kMostTurn_rad) {
        fault(key, shown_value, "is beyond two turns (4π rad)",
              "must be in rad: multiply degrees by π / 180");
      } else if (at >= 0 && turns && axis.group == AxisGroup::kHand &&
                 std::abs(value) > kTurn_rad) {
        fault(key, shown_value, "is beyond a turn (2π rad), which no finger's joints make together",
              "must be in rad: multiply degrees by π / 180");
      } else if (width > 0.0 && std::abs(value - first) > kBeyond * width) {
        fault(
            key, shown_value,
            fmt::format("is {:.3g} {} from the first row; the axis of {} has a range of {:.3g} {}",
                        std::abs(value - first), axis.positionUnit(), device_->name, width,
                        axis.positionUnit()),
            turns ? "must be in rad" : "must be in m: divide millimetres by 1000");
      } else if (axis.speed_limit > 0.0 && step > kBeyond * axis.speed_limit * step_s) {
        fault(key, shown_value,
              fmt::format("is reached at {:.3g} {}/s; the axis of {} moves at {:.3g} {}/s at most",
                          step / step_s, axis.positionUnit(), device_->name, axis.speed_limit,
                          axis.positionUnit()),
              "check its unit and that of time_s (s)");
      } else {
        continue;
      }
      break;
    }
  }
  line_ = 0;
}

/// Notes a time column that is probably in milliseconds: recordings have more than one row per
/// second. Notes missing rows: the reader interpolates a straight line that nobody moved.
void Reader::checkPace() {
  constexpr std::size_t kEnough = 10;
  constexpr double kGapSteps = 10.0, kLeastGap_s = 0.2;
  if (motion_.time_s.size() < kEnough) return;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < motion_.time_s.size(); ++i) {
    steps_s.push_back(motion_.time_s[i] - motion_.time_s[i - 1]);
  }
  // The usual step is the median.
  std::vector<double> sorted_s = steps_s;
  const auto middle = sorted_s.begin() + static_cast<std::ptrdiff_t>(sorted_s.size() / 2);
  std::nth_element(sorted_s.begin(), middle, sorted_s.end());
  const double usual_s = *middle;
  if (usual_s >= 1.0) {
    motion_.notices.push_back(keyFault(motion_.path, "time_s", "",
                                       fmt::format("has a row every {:.3g} s", usual_s),
                                       "if these are milliseconds, divide them by 1000"));
    return;
  }
  // Counts the gaps and names the longest.
  const double most_s = std::max(kGapSteps * usual_s, kLeastGap_s);
  const auto gaps =
      std::count_if(steps_s.begin(), steps_s.end(), [&](double step_s) { return step_s > most_s; });
  if (gaps == 0) return;
  const auto largest = std::max_element(steps_s.begin(), steps_s.end());
  const std::size_t row = static_cast<std::size_t>(largest - steps_s.begin()) + 1;
  std::string problem = fmt::format(
      "is {:.4g} s after the row before, where {:.3g} s are usual: the motion goes on in a "
      "straight "
      "line between them",
      *largest, usual_s);
  if (gaps > 1) problem += fmt::format(" (the longest of {} gaps)", gaps);
  Diagnostic notice =
      keyFault(motion_.path, "time_s", fmt::format("{:.10g}", motion_.time_s[row]),
               std::move(problem), "if rows were lost, fill them in or cut the file there");
  notice.line = lines_[row];
  motion_.notices.push_back(std::move(notice));
}

/// "1,234" is 1.234 in one file and 1234 in another.
void Reader::checkDecimals() {
  if (decimal_comma_ == 0) return;
  line_ = decimal_comma_;
  if (decimal_point_ > 0) {
    fault("", "", fmt::format("has decimal commas, and decimal points in line {}", decimal_point_),
          "write all numbers with a point, and none with commas between thousands");
  } else {
    Diagnostic notice =
        fileFault(motion_.path, "has decimal commas: \"0,5\" is read as 0.5", "nothing to do");
    notice.line = line_;
    motion_.notices.push_back(std::move(notice));
  }
}

void Reader::checkWhole() {
  checkDecimals();
  line_ = 0;
  if (header_.empty() && other_section_) {
    fault("", "", "holds no positions: only a section such as Devices or Events",
          "export it with the section Trajectories");
  } else if (header_.empty()) {
    fault("", "", "is empty", "the first line names the columns: time_s, x_m, ...");
  } else if (rows_ < 2) {
    fault("", "",
          std::string(rows_ == 0 ? "has no row of samples" : "has only 1 row of samples") +
              (only_.empty() ? "" : " that its line # columns keeps"),
          "at least 2 are needed");
  } else if (faults_.empty() && motion_.samples.size() < 2) {
    fault("", "",
          "has " + counted(motion_.samples.size(), "row") +
              " with a value of every column that is read",
          "at least 2 are needed");
  }
  if (!faults_.empty()) return;
  if (incomplete_ > 0) {
    motion_.notices.push_back(fileFault(motion_.path,
                                        "has " + counted(incomplete_, "row") +
                                            " without a value of a column that is read, left out",
                                        "nothing to do"));
  }
  checkValues();
  checkPace();
  if (device_ == nullptr || !faults_.empty()) return;
  const auto on_device = [this](const std::string& name) {
    return std::any_of(device_->axes.begin(), device_->axes.end(),
                       [&](const DeviceAxis& axis) { return axis.name == name; });
  };
  if (std::none_of(motion_.columns.begin(), motion_.columns.end(), on_device)) {
    fault("", "", "moves no axis of the device " + device_->name,
          "name at least one of its axes in a column");
  }
}

Expected<MotionFile> Reader::read() {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(motion_.path, error);
  if (std::filesystem::is_character_file(status) || std::filesystem::is_block_file(status)) {
    fault("", "", "is not a file", kGiveMotion);  // a device such as /dev/zero is endless
    return faults_;
  }
  std::ifstream file(motion_.path);
  if (!file.is_open()) {
    fault("", "", "cannot be opened", "check the path and the permissions");
    return faults_;
  }
  file.peek();
  if (file.bad()) {
    fault("", "", "cannot be read", "give a CSV file, not a folder");
    return faults_;
  }
  // Reads line by line; a line may end in \n, \r\n or \r.
  for (std::string whole; std::getline(file, whole);) {
    if (whole.ends_with('\r')) whole.pop_back();
    for (std::size_t begin = 0, end = 0; end != whole.npos; begin = end + 1) {
      end = whole.find('\r', begin);  // a \r without \n also ends a line
      ++line_;
      std::string_view text = std::string_view(whole).substr(begin, end - begin);
      if (line_ == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
      // A tab at an end may divide an empty cell from the others.
      text = trimmed(text).empty() ? std::string_view() : trimmed(text, " ");
      if (text.starts_with('#') && header_.empty()) readComment(text);
      if (header_.empty() && isNamesAfterSign(text)) text = trimmed(text.substr(1));
      if (text.empty() && mocap_.hasSections() && (rows_ > 0 || !early_.empty())) return finish();
      if (text.empty() || text.starts_with('#')) continue;
      if (!line(text)) return faults_;
    }
  }
  return finish();
}

Expected<MotionFile> Reader::finish() {
  readEarlyRows();
  checkWhole();
  if (unreported_ > 0) {
    faults_.push_back(fileFault(motion_.path, "has " + counted(unreported_, "more fault"),
                                "correct the ones above first"));
  }
  if (!faults_.empty()) return faults_;
  return std::move(motion_);
}

}  // namespace

Expected<MotionFile> loadMotionFile(const std::string& path, const DeviceModel* device) {
  return Reader(path, device).read();
}

}  // namespace wholehand
