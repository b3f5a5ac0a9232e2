#include "files/patient/mocap_head.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <string_view>

namespace wholehand {
namespace {

constexpr std::size_t kMostLines = 20;
constexpr std::size_t kNexusLines = 5;  // kind, rate, names, axes, units

std::string textAt(const std::vector<Cell>& line, std::size_t place) {
  return place < line.size() ? line[place].text : std::string();
}

/// The value behind a key in Motive's first line.
std::string valueOf(const std::vector<Cell>& line, std::string_view key) {
  const auto at =
      std::find_if(line.begin(), line.end(), [&](const Cell& cell) { return cell.text == key; });
  return at == line.end() || at + 1 == line.end() ? std::string() : (at + 1)->text;
}

double numberOf(const std::string& text) {
  double value = 0.0;
  (void)std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::string lengthUnit(const std::string& words) {
  if (words == "Millimeters") return " (mm)";
  if (words == "Centimeters") return " (cm)";
  return words == "Meters" ? " (m)" : "";
}

}  // namespace

bool MocapHead::begins(const std::vector<Cell>& first) {
  constexpr std::array<std::string_view, 6> kBegins = {
      "Format Version", "Trajectories", "Joints", "Model Outputs", "Objects", "Segments"};
  return std::find(kBegins.begin(), kBegins.end(), textAt(first, 0)) != kBegins.end();
}

bool MocapHead::isOtherSection(const std::vector<Cell>& first) {
  constexpr std::array<std::string_view, 2> kOthers = {"Devices", "Events"};
  return std::find(kOthers.begin(), kOthers.end(), textAt(first, 0)) != kOthers.end();
}

bool MocapHead::isNexus() const {
  return textAt(lines_.front(), 0) != "Format Version";
}

bool MocapHead::add(const std::vector<Cell>& line) {
  lines_.push_back(line);
  if (lines_.size() > kMostLines) return false;
  const bool names_axes = textAt(line, 0) == "Frame";
  if (!isNexus()) {
    complete_ = names_axes;
    return true;
  }
  complete_ = lines_.size() == kNexusLines;
  return names_axes == (lines_.size() == kNexusLines - 1);
}

std::string MocapHead::program() const {
  return isNexus() ? "Vicon Nexus" : "OptiTrack Motive";
}

double MocapHead::rate_hz() const {
  return complete_ && isNexus() ? numberOf(textAt(lines_[1], 0)) : 0.0;
}

std::vector<std::string> MocapHead::columns() const {
  std::vector<std::string> names;
  std::string marker;
  const std::vector<Cell>& axes = isNexus() ? lines_[kNexusLines - 2] : lines_.back();
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string& axis = axes[i].text;
    if (axis.empty() && i > 0) {  // a comma at the end
      names.emplace_back();
      continue;
    }
    if (isNexus()) {
      // The name of a marker stands above the first of its axes.
      const std::string name = textAt(lines_[2], i), unit = textAt(lines_[4], i);
      if (!name.empty()) marker = name.substr(name.rfind(':') + 1);
      const std::string of = marker.empty() ? axis : marker + " " + axis;
      names.push_back(unit.empty() ? of : of + " (" + unit + ")");
      continue;
    }
    if (axis == "Time (Seconds)") {
      names.emplace_back("Time (s)");
      continue;
    }
    // Above each axis stand rows such as Type, Name, ID and Position.
    std::string name, kind, type;
    for (std::size_t line = 1; line + 1 < lines_.size(); ++line) {
      if (textAt(lines_[line], 1) == "Name") name = textAt(lines_[line], i);
      if (textAt(lines_[line], 1) == "Type") type = textAt(lines_[line], i);
      if (line + 2 == lines_.size()) kind = textAt(lines_[line], i);
    }
    if (name.empty()) {
      names.push_back(axis);
      continue;
    }
    const bool turns = kind == "Rotation";
    const bool angles = valueOf(lines_[0], "Rotation Type") != "Quaternion";
    const std::string unit =
        turns ? (angles ? " (deg)" : "") : lengthUnit(valueOf(lines_[0], "Length Units"));
    const std::string of = kind + " " + axis + unit;
    // A bone and a marker on it may have one name.
    const bool again = std::find(names.begin(), names.end(), name + " " + of) != names.end();
    names.push_back(again ? name + " " + type + " " + of : name + " " + of);
  }
  return names;
}

}  // namespace wholehand
