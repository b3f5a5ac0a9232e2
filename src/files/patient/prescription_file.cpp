#include "files/patient/prescription_file.hpp"

#include "files/device/axis_keys.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace wholehand {
namespace {

constexpr std::size_t kLongestName = 100;
/// Relative rounding of a number in single precision.
constexpr double kSingle = 1e-7;
constexpr double kFurthest = 1e3;  // [m or rad]

const char* nameOf(Side side) {
  return side == Side::kRight ? "right" : "left";
}

double bandOf(const DeviceAxis& axis) {
  return axis.kind == AxisKind::kTranslation ? kLimitBand_m : kLimitBand_rad;
}

/// Index of the limit's axis; -1 after a fault.
int readAxis(TomlTable& table, const DeviceModel& device, std::vector<std::string>& named) {
  const std::string name = table.text("axis");
  if (!table.isGood("axis")) return -1;
  std::vector<std::string> known;
  for (const DeviceAxis& axis : device.axes) known.push_back(axis.name);
  const int index = device.axisIndex(name);
  if (index < 0) {
    const std::string near = nearestUnused(name, known, named);
    table.fail("axis", "is not an axis of the device " + printable(device.path),
               near.empty() ? "remove the limit" : "did you mean " + near + "?");
  } else if (std::count(named.begin(), named.end(), name) > 0) {
    table.fail("axis", "has a limit already", "write one limit for each axis");
  } else {
    named.push_back(name);
    return index;
  }
  return -1;
}

void readLimit(TomlTable& table, const DeviceModel& device, std::vector<std::string>& named,
               Prescription& out) {
  const int index = readAxis(table, device, named);
  if (index < 0) {
    table.ignoreUnknownKeys();
    return;
  }
  const DeviceAxis& axis = device.axes[index];
  const bool along = axis.kind == AxisKind::kTranslation;
  const char* const key = along ? "within_m" : "within_rad";
  table.refuse(along ? "within_rad" : "within_m", key,
               axis.name + (along ? " is a translation" : " is a rotation"));
  const auto [from, to] = table.interval(key, between(-kFurthest, kFurthest, axis.positionUnit()));
  if (!table.isGood(key)) return;
  // Pages know the ends of the device in single precision.
  if (from < axis.lower - kSingle * std::abs(axis.lower) ||
      to > axis.upper + kSingle * std::abs(axis.upper)) {
    table.fail(
        key, "leaves the device's range",
        fmt::format("must be in [{:.6g}, {:.6g}] {}", axis.lower, axis.upper, axis.positionUnit()));
    return;
  }
  const double lower = std::max(from, axis.lower), upper = std::min(to, axis.upper);
  if (upper - lower < 2.0 * bandOf(axis)) {
    table.fail(
        key, "is narrower than the walls at its two ends",
        fmt::format("must be at least {:.4g} {} wide", 2.0 * bandOf(axis), axis.positionUnit()));
    return;
  }
  out.limits.push_back({index, lower, upper});
}

Prescription::Corridor readCorridor(TomlTable table, const DeviceModel& device) {
  Prescription::Corridor out;
  out.radius_m = table.number("radius_m", between(0.005, 0.2, "m"));
  out.stiffness_n_m = table.number("stiffness_n_m", between(10.0, 1000.0, "N/m"));
  constexpr std::array kNames = {"x", "y", "z"};
  if (std::none_of(kNames.begin(), kNames.end(),
                   [&](const char* name) { return device.axisIndex(name) >= 0; })) {
    table.fail("",
               "is for a hand that is carried, and the device " + printable(device.path) +
                   " has none of the axes x, y, z",
               "remove it");
  }
  return out;
}

Prescription::Difficulty readDifficulty(TomlTable table) {
  Prescription::Difficulty out;
  out.aim = table.number("aim", between(0.5, 0.9), out.aim);
  out.lower = 0.0, out.upper = 1.0;
  if (table.has("bounds")) {
    const auto [lower, upper] = table.interval("bounds", between(0.0, 1.0));
    out.lower = lower, out.upper = upper;
  }
  return out;
}

}  // namespace

Expected<Prescription> loadPrescriptionFile(const std::string& path, const DeviceModel& device) {
  return readTomlFile<Prescription>(
      path, "prescription", [&device](TomlTable& root, Prescription& out) {
        out.name = root.text("name");
        if (out.name.size() > kLongestName) {
          root.fail("name", "is too long", "at most 100 bytes: a code, not a person's name");
        }
        out.side = root.choice("side", {nameOf(Side::kRight), nameOf(Side::kLeft)}) == "left"
                       ? Side::kLeft
                       : Side::kRight;
        std::vector<std::string> named;
        for (TomlTable& limit : root.tables("limits", 0)) readLimit(limit, device, named, out);
        if (auto table = root.optionalTable("corridor")) {
          out.corridor = readCorridor(*table, device);
        }
        if (auto table = root.optionalTable("difficulty")) out.difficulty = readDifficulty(*table);
      });
}

std::string prescriptionText(const std::string& name, const std::string& side,
                             const std::vector<LimitText>& limits) {
  std::string out = fmt::format(
      "kind = \"prescription\"\nversion = 1\nname = \"{}\"\nside = \"{}\"\n", name, side);
  for (const LimitText& limit : limits) {
    out += fmt::format("\n[[limits]]\naxis = \"{}\"\n{} = [{}, {}]\n", limit.axis,
                       limit.along ? "within_m" : "within_rad", limit.lower, limit.upper);
  }
  return out;
}

Diagnostics refuseOtherSide(const Prescription& prescription, const HandModel& hand) {
  if (prescription.side == hand.side) return {};
  return {keyFault(prescription.path, "side", nameOf(prescription.side),
                   fmt::format("is not the side of the hand {}, a {} one", printable(hand.name),
                               nameOf(hand.side)),
                   "choose the other hand, or the prescription for this one")};
}

}  // namespace wholehand
