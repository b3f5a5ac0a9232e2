#include "assembly/rig_checks.hpp"

#include "dynamics/articulated_body.hpp"
#include "renderer/live_settings.hpp"
#include "safety/neutral_ramp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace wholehand {
namespace {

void refuseAbove(int most, std::size_t count, const char* key, const char* what,
                 Diagnostics& refused) {
  if (std::cmp_less_equal(count, most)) return;
  refused.push_back({"", 0, key, std::to_string(count), "is more than a tick has room for",
                     std::string("at most ") + std::to_string(most) + " " + what});
}

// Slew from one limit to the other at the ramp's steepest. With less, neutral would be reached too
// late.
double leastSlew(const DeviceAxis& axis) {
  return 2.0 * axis.effort_limit * 1.5 / NeutralRampConfig{}.ramp_s;
}

// A limit of 0 renders nothing; a NaN limits nothing.
bool isLimit(double value) {
  return std::isfinite(value) && value > 0.0;
}

}  // namespace

Diagnostics refuseTooLarge(const Models& m) {
  Diagnostics refused;
  refuseAbove(kMaxSceneBodies, m.scene.bodies.size(), "bodies", "bodies in a scene", refused);
  refuseAbove(kMaxLinks, m.hand.links.size(), "links", "links in a hand", refused);
  refuseAbove(kMaxJoints, std::max(m.hand.joint_count, 0), "joints", "joints in a hand", refused);
  const std::size_t axes = std::max(m.hand.axis_count, 0);
  refuseAbove(kMaxAxes, std::max(axes, m.device.axes.size()), "axes", "axes of a device", refused);
  if (m.exercise == nullptr) return refused;
  const ExerciseDescription& exercise = m.exercise->description();
  refuseAbove(kMaxLiveParameters - kMostLiveSettings, exercise.parameters.size(), "parameters",
              "live parameters of an exercise", refused);
  refuseAbove(kMaxExerciseValues, exercise.value_names.size(), "values", "values of an exercise",
              refused);
  return refused;
}

Diagnostics refuseImpossibleLimits(const DeviceModel& device) {
  Diagnostics refused;
  const auto refuse = [&](const std::string& axis, const char* key, double value, const char* why,
                          const std::string& remedy) {
    refused.push_back({device.path, 0, axis + key, fmt::format("{:.6g}", value), why, remedy});
  };
  for (const DeviceAxis& axis : device.axes) {
    const std::string of = axis.name + ".";
    if (!isLimit(axis.effort_limit)) {
      refuse(of, "effort_limit", axis.effort_limit, "is not a valid limit", "must be a number > 0");
    }
    if (!isLimit(axis.speed_limit)) {
      refuse(of, "speed_limit", axis.speed_limit, "is not a valid limit", "must be a number > 0");
    }
    const double least_slew = leastSlew(axis);
    if (!isLimit(axis.effort_slew_limit) || axis.effort_slew_limit < least_slew) {
      refuse(of, "effort_slew_limit", axis.effort_slew_limit,
             "is not a number, or too low to reach neutral within 100 ms",
             fmt::format("must be at least {:.6g}", least_slew));
    }
    if (!(std::isfinite(axis.lower) && std::isfinite(axis.upper) && axis.lower < axis.upper)) {
      refuse(of, "range", axis.lower, "is not a valid range",
             "the lower end must be below the upper one");
    }
    if (!(std::isfinite(axis.workspace_margin) && axis.workspace_margin >= 0.0)) {
      refuse(of, "workspace_margin", axis.workspace_margin, "is not a valid margin",
             "must be >= 0");
    }
    if (!(std::abs(axis.neutral_effort) <= axis.effort_limit)) {
      refuse(of, "neutral_effort", axis.neutral_effort, "exceeds the effort limit",
             "the device could not carry its own weight");
    }
  }
  if (!(device.power_limit_w > 0.0)) {  // infinity: no limit
    refuse("", "power_limit_w", device.power_limit_w, "is not a valid limit", "must be > 0");
  }
  return refused;
}

Diagnostics refuseHeavyArmature(const Models& models, const CouplingGains& gains, double period_s) {
  Diagnostics refused;
  for (int a = 0; a < gains.axes; ++a) {
    const DeviceAxis& axis = models.device.axes[a];
    const AxisRendering& rendering = models.rendering.axes[a];
    const double felt = feltInertia(gains, a, period_s);
    if (!rendering.armature || felt <= axis.mass) continue;
    const bool translation = axis.kind == AxisKind::kTranslation;
    const char* unit = translation ? "kg" : "kg·m²";
    const double lever_sq = axis.lever_arm_m * axis.lever_arm_m;
    const std::string at_tip =
        lever_sq > 0.0 ? fmt::format(", {:.3g} g at the tip", 1e3 * felt / lever_sq) : "";
    refused.push_back(
        {models.rendering.path, 0,
         fmt::format("axes[{}].armature_{}", axis.name, translation ? "kg" : "kg_m2"),
         fmt::format("{:.6g}", *rendering.armature),
         fmt::format(
             "makes the hand a weight: the avatar is felt as {:.3g} {}{}, the device itself "
             "as {:.3g}",
             felt, unit, at_tip, axis.mass),
         "state less, or leave it out: the rule then adds what the rate needs"});
  }
  return refused;
}

}  // namespace wholehand
