#include "exercises/task_needs.hpp"

#include "loop/core/printable.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace wholehand {
namespace {

/// The fingers open by so much more than the object, and close by so much more than its surface.
constexpr double kOpens_rad = 10.0 * kDeg, kCloses_rad = 5.0 * kDeg;

/// Distance of the capsules of the bent fingers from an upright line, less their radii.
double fingersFrom(const HandModel& hand, const ArticulatedBody& body,
                   const Eigen::Vector3d& line_m) {
  constexpr int kSamples = 5;
  double least_m = std::numeric_limits<double>::infinity();
  for (const Capsule& capsule : hand.capsules) {
    const std::string& link = hand.links[capsule.link].name;
    if (link.find("thumb") != std::string::npos || link.find("flexion") == std::string::npos)
      continue;
    const Pose& at = body.linkPose(capsule.link);
    const Eigen::Vector3d a_m = at * capsule.a_m, b_m = at * capsule.b_m;
    for (int i = 0; i < kSamples; ++i) {
      const Eigen::Vector3d point_m = a_m + (b_m - a_m) * i / (kSamples - 1.0);
      least_m = std::min(least_m, (point_m - line_m).head<2>().norm() - capsule.radius_m);
    }
  }
  return least_m;
}

/// Flexion at which the fingers meet an upright cylinder beside the palm; the axis's upper end if
/// they never do.
double flexionOn(const PlayerReach& reach, const HandModel& hand, double radius_m) {
  ArticulatedBody body(hand);
  const Synergy synergy(hand);
  AxisPosition q_s(reach.axes);
  constexpr double kStep_rad = 1.0 * kDeg;
  // The straight fingers may be beside the object, where they do not meet its far side.
  constexpr double kFrom_rad = 65.0 * kDeg;
  for (double at = kFrom_rad; at < reach.upper[reach.fingers]; at += kStep_rad) {
    q_s[reach.fingers] = at;
    JointPosition theta;
    synergy.expand(q_s, theta);
    body.updateKinematics(theta);
    if (fingersFrom(hand, body, reach.grip_m) <= radius_m) return at;
  }
  return reach.upper[reach.fingers];
}

std::string shown(const DeviceAxis& axis, double from, double to) {
  const bool along = axis.kind == AxisKind::kTranslation;
  return along ? fmt::format("{:.0f} to {:.0f} mm", 1e3 * from, 1e3 * to)
               : fmt::format("{:.0f} to {:.0f}°", from / kDeg, to / kDeg);
}

}  // namespace

void TaskNeeds::add(int axis, double at) {
  if (axis < 0) return;
  const auto known = std::find_if(needs_.begin(), needs_.end(),
                                  [axis](const TaskNeed& need) { return need.axis == axis; });
  if (known == needs_.end()) {
    needs_.push_back({axis, at, at});
    return;
  }
  known->lower = std::min(known->lower, at);
  known->upper = std::max(known->upper, at);
}

void TaskNeeds::addBase(const PlayerReach& reach, const Eigen::Vector3d& base_m) {
  add(reach.x, base_m.x());
  add(reach.y, base_m.y());
  add(reach.z, base_m.z());
}

void TaskNeeds::addGrasp(const PlayerReach& reach, const HandModel& hand, double radius_m) {
  if (reach.fingers < 0) return;
  const double on = flexionOn(reach, hand, radius_m);
  add(reach.fingers, on - kOpens_rad);
  add(reach.fingers, on + kCloses_rad);
}

DeviceModel deviceWithin(const DeviceModel& device, const Prescription& prescription) {
  DeviceModel out = device;
  for (const Prescription::Limit& limit : prescription.limits) {
    DeviceAxis& axis = out.axes[limit.axis];
    const double band = axis.kind == AxisKind::kTranslation ? kLimitBand_m : kLimitBand_rad;
    if (limit.lower > axis.lower) axis.lower = limit.lower + band;
    if (limit.upper < axis.upper) axis.upper = limit.upper - band;
  }
  return out;
}

Expected<Eigen::Vector3d> placeWithin(const TaskNeeds& needs, const DeviceModel& within,
                                      const std::string& exercise,
                                      const Prescription& prescription) {
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();
  Diagnostics faults;
  for (const TaskNeed& need : needs.all()) {
    const DeviceAxis& axis = within.axes[need.axis];
    const auto at = std::find(kNames.begin(), kNames.end(), axis.name) - kNames.begin();
    const bool moves = at < static_cast<std::ptrdiff_t>(kNames.size());
    const double room = axis.upper - axis.lower, needed = need.upper - need.lower;
    const bool fits = moves ? needed <= room : axis.lower <= need.lower && need.upper <= axis.upper;
    if (!fits) {
      faults.push_back(
          keyFault(prescription.path, "limits", axis.name,
                   fmt::format("leave {} without their walls, and {} needs {}",
                               moves ? fmt::format("{:.0f} mm", 1e3 * std::max(0.0, room))
                                     : shown(axis, axis.lower, axis.upper),
                               printable(exercise),
                               moves ? fmt::format("{:.0f} mm", 1e3 * needed)
                                     : shown(axis, need.lower, need.upper)),
                   "widen this limit, or choose another exercise"));
    } else if (moves) {
      // Adding 0 turns -0 into 0.
      moved_m[at] = std::clamp(0.0, axis.lower - need.lower, axis.upper - need.upper) + 0.0;
    }
  }
  if (!faults.empty()) return faults;
  return moved_m;
}

}  // namespace wholehand
