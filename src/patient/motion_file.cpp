#include "patient/motion.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>

namespace wholehand {
namespace {

constexpr std::size_t kMostFaults = 20;
constexpr double kLargestValue = 1000.0;  // m or rad: beyond it no hand moves
constexpr double kLongest_s = 3600.0;

struct KnownAxis {
  std::string_view name;
  AxisKind kind;
};
constexpr std::array<KnownAxis, 9> kUsualAxes{{{"x", AxisKind::kTranslation},
                                               {"y", AxisKind::kTranslation},
                                               {"z", AxisKind::kTranslation},
                                               {"roll", AxisKind::kRotation},
                                               {"pitch", AxisKind::kRotation},
                                               {"yaw", AxisKind::kRotation},
                                               {"finger_flexion", AxisKind::kRotation},
                                               {"thumb_circumduction", AxisKind::kRotation},
                                               {"thumb_flexion", AxisKind::kRotation}}};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> cells(std::string_view line) {
  std::vector<std::string_view> found;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = line.find(',', begin);
    found.push_back(trimmed(line.substr(begin, comma - begin)));
    if (comma == std::string_view::npos) return found;
    begin = comma + 1;
  }
}

/// The device's axis of that name, else the usual one.
std::optional<AxisKind> kindOf(std::string_view name, const DeviceModel* device) {
  if (device != nullptr) {
    for (const DeviceAxis& axis : device->axes) {
      if (axis.name == name) return axis.kind;
    }
  }
  for (const KnownAxis& axis : kUsualAxes) {
    if (axis.name == name) return axis.kind;
  }
  return std::nullopt;
}

std::string axisNames(const DeviceModel* device) {
  std::string names;
  for (const KnownAxis& axis : kUsualAxes) {
    names += (names.empty() ? "" : ", ") + std::string(axis.name);
  }
  if (device == nullptr) return names;
  for (const DeviceAxis& axis : device->axes) {
    if (kindOf(axis.name, nullptr)) continue;
    names += ", " + axis.name;
  }
  return names;
}

/// Reads one file line by line and gathers every fault.
class Reader {
 public:
  Reader(const std::string& path, const DeviceModel* device) : device_(device) {
    motion_.path = path;
  }

  Expected<MotionFile> read();

 private:
  void header(std::string_view line);
  void column(std::string_view name, std::size_t place);
  void row(std::string_view line);
  std::optional<double> number(std::string_view cell, std::size_t place);
  void checkTime(double time_s, std::string_view cell);
  void checkWhole();
  void fault(std::string key, std::string_view value, std::string problem, std::string remedy);

  const DeviceModel* device_;
  MotionFile motion_;
  Diagnostics faults_;
  std::size_t untold_ = 0;
  int line_ = 0;
  std::vector<std::string> header_;  // the columns as written
  std::size_t time_place_ = 0;
  int rows_ = 0;
};

void Reader::fault(std::string key, std::string_view value, std::string problem,
                   std::string remedy) {
  if (faults_.size() == kMostFaults) {
    ++untold_;
    return;
  }
  faults_.push_back({motion_.path, line_, std::move(key), std::string(value.substr(0, 40)),
                     std::move(problem), std::move(remedy)});
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

void Reader::header(std::string_view line) {
  const std::vector<std::string_view> names = cells(line);
  for (std::size_t i = 0; i < names.size(); ++i) {
    header_.emplace_back(names[i]);
    column(names[i], i);
  }
  const auto time = std::find(header_.begin(), header_.end(), "time_s");
  if (time == header_.end()) {
    fault("time_s", "", "is missing", "add a column time_s with the time of each row in seconds");
  }
  time_place_ = static_cast<std::size_t>(time - header_.begin());
  if (faults_.empty() && motion_.columns.empty()) {
    fault("", "", "has no axis column", "add a column such as x_m or finger_flexion_rad");
  }
}

std::optional<double> Reader::number(std::string_view cell, std::size_t place) {
  const std::string& key = header_[place];
  double value = 0.0;
  // from_chars takes no leading plus and, unlike strtod, does not depend on the locale.
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
          "has " + std::to_string(values.size()) + " values, the header names " +
              std::to_string(header_.size()) + " columns",
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
    fault("", "", "has " + std::to_string(rows_) + " rows of samples", "at least 2 are needed");
  }
  if (device_ == nullptr || !faults_.empty()) return;
  const auto onDevice = [this](const std::string& name) {
    return std::any_of(device_->axes.begin(), device_->axes.end(),
                       [&](const DeviceAxis& axis) { return axis.name == name; });
  };
  if (std::none_of(motion_.columns.begin(), motion_.columns.end(), onDevice)) {
    fault("", "", "moves no axis of the device " + device_->name,
          "name at least one of its axes in a column");
  }
}

Expected<MotionFile> Reader::read() {
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
  for (std::string line; std::getline(file, line);) {
    ++line_;
    std::string_view text = line;
    if (line_ == 1 && text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark
    text = trimmed(text);
    if (text.empty() || text.starts_with('#')) continue;
    if (header_.empty()) {
      header(text);
    } else {
      row(text);
    }
  }
  checkWhole();
  if (untold_ > 0) {
    faults_.push_back({motion_.path, 0, "", "", "has " + std::to_string(untold_) + " more faults",
                       "mend the ones above first"});
  }
  if (!faults_.empty()) return faults_;
  return std::move(motion_);
}

}  // namespace

Expected<MotionFile> loadMotionFile(const std::string& path, const DeviceModel* device) {
  return Reader(path, device).read();
}

}  // namespace wholehand
