#include "files/device/device_file.hpp"

#include "files/device/axis_keys.hpp"
#include "files/toml/toml_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <optional>

namespace wholehand {
namespace {

// Bounds are far beyond any device for a hand: they detect wrong units.
constexpr AxisQuantity kEffortLimit{
    "effort_limit_n", "effort_limit_nm", "effort_limit_tip_n", 1, 0.0, 1000.0, true};
constexpr AxisQuantity kEffortSlew{
    "effort_slew_n_s", "effort_slew_nm_s", "effort_slew_tip_n_s", 1, 0.0, 1e6, true};
constexpr AxisQuantity kWorkspaceMargin{
    "workspace_margin_m", "workspace_margin_rad", {}, 1, 0.0, 1.0, true};
constexpr AxisQuantity kSpeedLimit{"speed_limit_m_s", "speed_limit_rad_s", {}, 1, 0.0, 100.0, true};
constexpr AxisQuantity kMass{"mass_kg", "inertia_kg_m2", {}, 1, 0.0, 100.0, true};
constexpr AxisQuantity kDamping{"damping_n_s_m", "damping_nm_s_rad", {}, 1, 0.0, 1000.0};
constexpr AxisQuantity kCoulomb{"coulomb_n", "coulomb_nm", "coulomb_tip_n", 1, 0.0, 100.0};
constexpr AxisQuantity kEncoderStep{"encoder_step_m", "encoder_step_rad", {}, 1, 0.0, 0.1};
constexpr AxisQuantity kNeutral{
    "neutral_effort_n", "neutral_effort_nm", "neutral_effort_tip_n", 1, -1000.0, 1000.0};

// Defaults of optional keys.
constexpr double kSlewOfLimit_per_s = 250.0;  // zero to the effort limit in 4 ms
constexpr double kMarginOfRange = 0.02;
constexpr WatchLimits kWatch{5, 0.02, 1.0};
// Steepest slope, with some margin, of a smoothstep over 80 ms from +limit to -limit. A device with
// a lower slew limit could not follow the ramp to neutral.
constexpr double kLeastSlewOfLimit_per_s = 40.0;

/// Quantities that have separate keys for translations and for rotations.
constexpr std::array<AxisQuantity, 11> kOfOneKind{{{"range_m", "range_rad"},
                                                   {"", "lever_arm_m"},
                                                   kEffortLimit,
                                                   kEffortSlew,
                                                   kWorkspaceMargin,
                                                   kSpeedLimit,
                                                   kMass,
                                                   kDamping,
                                                   kEncoderStep,
                                                   kCoulomb,
                                                   kNeutral}};

/// Kind of an axis whose `type` is unusable, guessed from the units of its keys; empty when both
/// kinds have equally many.
std::optional<AxisKind> kindOfKeys(const TomlTable& table) {
  int translations = 0, rotations = 0;
  for (const AxisQuantity& quantity : kOfOneKind) {
    if (table.has(quantity.translation_key)) ++translations;
    if (table.has(quantity.rotation_key) || table.has(quantity.tip_key)) ++rotations;
  }
  if (translations == rotations) return std::nullopt;
  return rotations > translations ? AxisKind::kRotation : AxisKind::kTranslation;
}

bool isAxisName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_';
  });
}

/// Checks a base axis, which carries the hand: its name determines direction and kind.
void checkBaseAxis(TomlTable& table, const DeviceAxis& axis) {
  const std::vector<std::string> translations = {"x", "y", "z"};
  const std::vector<std::string> rotations = {"roll", "pitch", "yaw"};
  const auto in = [&](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), axis.name) != names.end();
  };
  const bool turns = axis.kind == AxisKind::kRotation;
  if (in(translations) && turns) {
    table.fail("type", "does not match this name", "write type = \"translation\"");
  } else if (in(rotations) && !turns) {
    table.fail("type", "does not match this name", "write type = \"rotation\"");
  } else if (!in(translations) && !in(rotations)) {
    table.fail("name", "is not an axis that carries the hand",
               "must be x, y, z, roll, pitch or yaw, or write group = \"hand\"");
  }
}

void readName(TomlTable& table, DeviceAxis& axis, const std::vector<std::string>& earlier) {
  axis.name = table.text("name");
  if (!table.isGood("name")) return;
  if (!isAxisName(axis.name)) {
    table.fail("name", "is not a name", "use lower-case letters, digits and underscores");
    return;
  }
  const bool judged = table.isGood("type") && axis.group == AxisGroup::kBase;
  if (checkNewName(table, axis.name, earlier) && judged) {
    checkBaseAxis(table, axis);
  }
}

void checkSlew(TomlTable& table, const DeviceAxis& axis) {
  const auto good = [&](const AxisQuantity& quantity) {
    return table.isGood(quantity.translation_key) || table.isGood(quantity.rotation_key) ||
           table.isGood(quantity.tip_key);
  };
  if (!good(kEffortLimit) || !good(kEffortSlew)) return;  // already reported, or absent
  if (axis.effort_slew_limit >= kLeastSlewOfLimit_per_s * axis.effort_limit) return;
  const std::string_view key = table.has(kEffortSlew.translation_key) ? kEffortSlew.translation_key
                               : table.has(kEffortSlew.rotation_key)  ? kEffortSlew.rotation_key
                                                                      : kEffortSlew.tip_key;
  table.fail(key, "is too low to reach neutral within 100 ms",
             "write at least " + formatNumber(kLeastSlewOfLimit_per_s) +
                 " times the effort limit, per second");
}

/// Reads every key except type, group and name.
void readQuantities(TomlTable& table, DeviceAxis& axis) {
  const bool turns = axis.kind == AxisKind::kRotation;
  const std::array<double, 2> range =
      turns ? table.interval("range_rad",
                             between(-4.0 * std::numbers::pi, 4.0 * std::numbers::pi, "rad"))
            : table.interval("range_m", between(-10.0, 10.0, "m"));
  axis.lower = range[0];
  axis.upper = range[1];
  if (turns) axis.lever_arm_m = table.number("lever_arm_m", between(0.0, 1.0, "m"), 0.0);
  const double lever = axis.lever_arm_m;
  axis.effort_limit = readAxisQuantity(table, kEffortLimit, axis.kind, lever);
  axis.effort_slew_limit = readAxisQuantity(table, kEffortSlew, axis.kind, lever,
                                            kSlewOfLimit_per_s * axis.effort_limit);
  checkSlew(table, axis);
  axis.workspace_margin = readAxisQuantity(table, kWorkspaceMargin, axis.kind, lever,
                                           kMarginOfRange * (axis.upper - axis.lower));
  axis.speed_limit = readAxisQuantity(table, kSpeedLimit, axis.kind, lever);
  axis.mass = readAxisQuantity(table, kMass, axis.kind, lever);
  axis.damping = readAxisQuantity(table, kDamping, axis.kind, lever);
  axis.coulomb = readAxisQuantity(table, kCoulomb, axis.kind, lever, 0.0);
  axis.encoder_step = readAxisQuantity(table, kEncoderStep, axis.kind, lever, 0.0);
  axis.neutral_effort = readAxisQuantity(table, kNeutral, axis.kind, lever, 0.0);
  if (std::abs(axis.neutral_effort) > axis.effort_limit) {
    table.fail("", "the neutral effort exceeds the effort limit",
               "the device could not carry its own weight: raise the limit or lower the neutral");
  }
}

DeviceAxis readAxis(TomlTable& table, const std::vector<std::string>& earlier) {
  DeviceAxis axis;
  axis.kind = table.choice("type", {"translation", "rotation"}) == "rotation"
                  ? AxisKind::kRotation
                  : AxisKind::kTranslation;
  axis.group =
      table.choice("group", {"base", "hand"}) == "hand" ? AxisGroup::kHand : AxisGroup::kBase;
  readName(table, axis, earlier);
  if (!table.isGood("type")) {
    const std::optional<AxisKind> kind = kindOfKeys(table);
    if (!kind) {  // the kind stays unknown: further messages would mislead
      table.ignoreUnknownKeys();
      return axis;
    }
    axis.kind = *kind;
  }
  readQuantities(table, axis);
  return axis;
}

WatchLimits readWatch(TomlTable table) {
  WatchLimits watch;
  watch.late_in_a_row =
      static_cast<int>(table.integer("late_in_a_row", 0, 1000000, kWatch.late_in_a_row));
  watch.longest_gap_s =
      table.number("longest_gap_s", between(0.0, 10.0, "s"), kWatch.longest_gap_s);
  watch.stuck_encoder_s =
      table.number("stuck_encoder_s", between(0.0, 60.0, "s"), kWatch.stuck_encoder_s);
  return watch;
}

void readDevice(TomlTable& root, DeviceModel& device) {
  device.name = root.text("name");
  device.output_delay_ticks = static_cast<int>(root.integer("output_delay_ticks", 0, 8));
  device.drive_lag_s = root.number("drive_lag_s", between(0.0, 0.02, "s"), device.drive_lag_s);
  device.power_limit_w = root.number("power_limit_w", above(0.0, 1e5, "W"), device.power_limit_w);
  const std::optional<TomlTable> watch = root.optionalTable("watch");
  device.watch = watch ? readWatch(*watch) : kWatch;
  TomlTable mount = root.table("mount");
  const NumberRule turn = between(-std::numbers::pi, std::numbers::pi, "rad");
  device.mount_roll_rad = mount.number("roll_rad", turn);
  device.mount_pitch_rad = mount.number("pitch_rad", turn);
  device.mount_yaw_rad = mount.number("yaw_rad", turn);

  std::vector<std::string> names;
  for (TomlTable& table : root.tables("axes", 1)) {
    device.axes.push_back(readAxis(table, names));
    names.push_back(device.axes.back().name);
  }
  if (device.axisCount() > kMaxAxes) {
    root.fail("axes", "are too many", "a device has at most " + std::to_string(kMaxAxes));
  }
}

}  // namespace

Expected<DeviceModel> loadDeviceFile(const std::string& path) {
  return readTomlFile<DeviceModel>(path, "device", readDevice);
}

}  // namespace wholehand
