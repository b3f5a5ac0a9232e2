#include "model/axis_keys.hpp"
#include "patient/motion.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace wholehand {
namespace {

/// Bytes of the first UTF-8 character; 0 if it is invalid.
std::size_t characterBytes(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  const std::size_t bytes = lead < 0x80   ? 1
                            : lead < 0xC2 ? 0
                            : lead < 0xE0 ? 2
                            : lead < 0xF0 ? 3
                            : lead < 0xF5 ? 4
                                          : 0;
  if (bytes > text.size()) return 0;
  const bool whole =
      std::all_of(text.begin() + 1, text.begin() + static_cast<long>(bytes ? bytes : 1),
                  [](unsigned char c) { return (c & 0xC0U) == 0x80U; });
  return whole ? bytes : 0;
}

/// The text without blanks at both ends.
std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// Comma-separated values of a line, each trimmed.
std::vector<std::string_view> cells(std::string_view line) {
  std::vector<std::string_view> found;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    found.push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == std::string_view::npos) return found;
    begin = comma + 1;
  }
}

/// True if the text has control bytes: the file is not text, or UTF-16.
bool holdsControl(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) {
    return (c < 0x20 && c != '\t' && c != '\r') || c == 0x7F;
  });
}

/// A value for a message: shortened, and safe for terminals.
std::string shown(std::string_view value) {
  constexpr std::size_t kLongest = 40;
  std::string out;
  while (!value.empty() && out.size() < kLongest) {
    const std::size_t bytes = characterBytes(value);
    out += bytes > 0 ? value.substr(0, bytes) : "?";
    value.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  return out;
}

/// "1 value", "2 values"
std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

constexpr std::size_t kMostFaults = 20;
constexpr double kLargestValue = 1000.0;  // m or rad: beyond any hand motion
constexpr double kLongest_s = 3600.0;
constexpr const char* kGiveMotion =
    "give a CSV file whose first line names the columns: time_s, x_m, ...";

/// Why a first line is no header of a motion; empty if it is one.
std::string noHeader(const std::vector<std::string_view>& names) {
  const bool any = std::any_of(names.begin(), names.end(), [](std::string_view name) {
    return name == "time_s" || name.ends_with("_m") || name.ends_with("_rad");
  });
  if (names.size() == 1 && names.front().find_first_of(";\t") != std::string_view::npos) {
    return "is not a CSV file of commas: its columns are divided by something else";
  }
  return any ? "" : "is not a motion: its first line names no columns";
}

/// Kind of the device's axis of that name, else of the usual one.
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
  /// False when the file is not a motion and further faults would be noise.
  bool line(std::string_view text);
  bool header(std::string_view line);
  void column(std::string_view name, std::size_t place);
  void row(std::string_view line);
  std::optional<double> number(std::string_view cell, std::size_t place);
  void checkTime(double time_s, std::string_view cell);
  void checkWhole();
  void fault(std::string key, std::string_view value, std::string problem, std::string remedy);

  const DeviceModel* device_;
  MotionFile motion_;
  Diagnostics faults_;
  std::size_t unreported_ = 0;
  int line_ = 0;
  std::vector<std::string> header_;  // the columns as written
  std::size_t time_place_ = 0;
  int rows_ = 0;
};

void Reader::fault(std::string key, std::string_view value, std::string problem,
                   std::string remedy) {
  if (faults_.size() == kMostFaults) {
    ++unreported_;
    return;
  }
  faults_.push_back(
      {motion_.path, line_, std::move(key), shown(value), std::move(problem), std::move(remedy)});
}

void Reader::column(std::string_view name, std::size_t place) {
  const std::string key = "column " + std::to_string(place + 1);
  if (name.empty()) {
    fault(key, name, "has no name", "name it time_s, <axis>_m or <axis>_rad");
    return;
  }
  if (std::find(header_.begin(), header_.end() - 1, name) != header_.end() - 1) {
    fault(key, name, "stands there twice", "keep one of the two columns");
    return;
  }
  if (name == "time_s") return;
  const bool metres = name.ends_with("_m");
  if (!metres && !name.ends_with("_rad")) {
    fault(key, name, "has no known unit", "end it in _m for a translation, _rad for a rotation");
    return;
  }
  const std::string_view axis = name.substr(0, name.size() - (metres ? 2 : 4));
  const std::optional<AxisKind> kind = kindOf(axis, device_);
  if (!kind) {
    fault(key, name, "is no known axis", "use one of " + axisNames(device_));
  } else if ((*kind == AxisKind::kTranslation) != metres) {
    fault(key, name, "has the wrong unit",
          std::string(axis) + (metres ? " is a rotation: use _rad" : " is a translation: use _m"));
  }
  motion_.columns.emplace_back(axis);
}

bool Reader::header(std::string_view line) {
  const std::vector<std::string_view> names = cells(line);
  if (std::string why = noHeader(names); !why.empty()) {
    fault("", "", std::move(why), kGiveMotion);
    return false;
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    header_.emplace_back(names[i]);
    column(names[i], i);
  }
  const auto time = std::find(header_.begin(), header_.end(), "time_s");
  if (time == header_.end()) {
    fault("time_s", "", "is missing", "add a column time_s with the time of each row in seconds");
  }
  time_place_ = time - header_.begin();
  if (faults_.empty() && motion_.columns.empty()) {
    fault("", "", "has no axis column", "add a column such as x_m or finger_flexion_rad");
  }
  return true;
}

bool Reader::line(std::string_view text) {
  if (holdsControl(text)) {
    fault("", "", "is not a CSV text: it holds bytes that no text has", kGiveMotion);
    return false;
  }
  if (!header_.empty()) {
    row(text);
    return true;
  }
  return header(text);
}

std::optional<double> Reader::number(std::string_view cell, std::size_t place) {
  const std::string& key = header_[place];
  double value = 0.0;
  // from_chars accepts no leading plus; unlike strtod it ignores the locale.
  const std::string_view digits = cell.starts_with('+') ? cell.substr(1) : cell;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (cell.empty()) {
    fault(key, cell, "is empty", "write a number");
  } else if (end != digits.data() + digits.size() || error == std::errc::invalid_argument) {
    fault(key, cell, "is not a number", "write a decimal number such as 0.125");
  } else if (error == std::errc::result_out_of_range || !std::isfinite(value)) {
    fault(key, cell, "is not finite", "write a finite number");
  } else if (place != time_place_ && std::abs(value) > kLargestValue) {
    fault(key, cell, "is out of range", "must be in [-1000, 1000] m or rad");
  } else {
    return value;
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
  const std::vector<std::string_view> values = cells(line);
  if (values.size() != header_.size()) {
    fault("", "",
          "has " + counted(values.size(), "value") + ", the header names " +
              counted(header_.size(), "column"),
          "give every row one value a column");
    return;
  }
  std::vector<double> sample;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::optional<double> value = number(values[i], i);
    if (!value) continue;
    if (i == time_place_) {
      checkTime(*value, values[i]);
    } else {
      sample.push_back(*value);
    }
  }
  motion_.samples.push_back(std::move(sample));
}

void Reader::checkWhole() {
  line_ = 0;
  if (header_.empty()) {
    fault("", "", "is empty", "the first line names the columns: time_s, x_m, ...");
  } else if (rows_ < 2) {
    fault("", "", rows_ == 0 ? "has no row of samples" : "has only 1 row of samples",
          "at least 2 are needed");
  }
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
    fault("", "", "is not a file", kGiveMotion);  // /dev/zero never ends
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
  for (std::string whole; std::getline(file, whole);) {
    ++line_;
    std::string_view text = whole;
    if (line_ == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
    text = trimmed(text);
    if (text.empty() || text.starts_with('#')) continue;
    if (!line(text)) return faults_;
  }
  checkWhole();
  if (unreported_ > 0) {
    faults_.push_back({motion_.path, 0, "", "", "has " + counted(unreported_, "more fault"),
                       "correct the ones above first"});
  }
  if (!faults_.empty()) return faults_;
  return std::move(motion_);
}

}  // namespace

Expected<MotionFile> loadMotionFile(const std::string& path, const DeviceModel* device) {
  return Reader(path, device).read();
}

}  // namespace wholehand
