#include "exercises/finger_wall_file.hpp"

#include "files/device/axis_keys.hpp"
#include "loop/core/printable.hpp"

#include <optional>

namespace wholehand {
namespace {

constexpr AxisQuantity kStiffness{
    "stiffness_n_m", "stiffness_nm_rad", "stiffness_tip_n_m", 2, 0.0, 1e5};
/// Share of an axis's effort limit available to a wall.
constexpr double kCapShare = 0.9;

void readWallAxis(NamedAxis& named, const DeviceModel& device, FingerWallConfig& walls) {
  for (const char* key : {"damping_tip_n_s_m", "damping_nm_s_rad", "damping_n_s_m"}) {
    if (named.table.allowKey(key)) {
      named.table.fail(key, "has no place beside a liquid",
                       "remove it; viscosity_pa_s says how fast the wall gives way");
    }
  }
  const int i = device.axisIndex(named.name);
  if (i < 0) {
    const std::optional<AxisKind> kind = knownAxisKind(named.name);
    if (kind) {  // a standard axis that this device lacks; its keys are checked too
      named.table.fail("name", "the device " + printable(device.path) + " has no such axis",
                       "take a device that has it; every device plays a motion: "
                       "--scene F --motion F");
      (void)readAxisQuantity(named.table, kStiffness, *kind, 1.0);
    } else {
      named.table.fail(
          "name",
          "is neither an axis of the device " + printable(device.path) + " nor a standard axis",
          "remove it, or write the name of a hand axis");
      named.table.ignoreUnknownKeys();
    }
    return;
  }
  const DeviceAxis& axis = device.axes[i];
  if (axis.group != AxisGroup::kHand) {
    named.table.fail("name", "carries the hand and does not close it",
                     "write the name of an axis that moves the hand's joints");
    named.table.ignoreUnknownKeys();
    return;
  }
  walls.stiffness[i] = readAxisQuantity(named.table, kStiffness, axis.kind, axis.lever_arm_m);
}

}  // namespace

FingerWallFile readFingerWalls(TomlTable& wall, const DeviceModel& device) {
  FingerWallFile out;
  out.lead_in_m = wall.number("lead_in_m", between(0.0, kLargestLeadIn_m, "m"));
  TransitionConfig& t = out.transition;
  t.engage_m = wall.number("engage_m", above(0.0, 1.0, "m"));
  t.release_m = wall.number("release_m", above(0.0, 1.0, "m"));
  if (wall.isGood("engage_m") && wall.isGood("release_m") && t.release_m < t.engage_m) {
    wall.fail("release_m", "is less than engage_m", "must be at least engage_m");
  }
  // Lower bound 0.3 s: the largest effort of a wall, 10 N at the tip, then changes by 0.05 N per
  // tick.
  t.engage_s = wall.number("engage_s", between(0.3, 10.0, "s"), t.engage_s);
  t.release_s = wall.number("release_s", between(0.3, 5.0, "s"), t.release_s);
  const int n = device.axisCount();
  out.walls.axes = n;
  out.walls.lever_arm_m = AxisLength(n, 1.0);
  out.walls.stiffness = AxisStiffness(n);
  out.walls.effort_cap = out.effort_limit = AxisEffort(n);
  for (int i = 0; i < n; ++i) {
    const DeviceAxis& axis = device.axes[i];
    if (axis.lever_arm_m > 0.0) out.walls.lever_arm_m[i] = axis.lever_arm_m;
    out.effort_limit[i] = axis.effort_limit;
    out.walls.effort_cap[i] = kCapShare * axis.effort_limit;
  }
  out.walls.follow_m_s = wall.number("follow_m_s", above(0.0, 1.0, "m/s"), out.walls.follow_m_s);
  for (NamedAxis& named : readAxisNames(wall)) readWallAxis(named, device, out.walls);
  return out;
}

}  // namespace wholehand
