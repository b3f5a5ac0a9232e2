#include "loop/renderer/live_settings.hpp"

#include <algorithm>

namespace wholehand {

ParameterRamps::ParameterRamps(const std::vector<LiveParameter>& parameters)
    : count_(std::min(static_cast<int>(parameters.size()), kMaxLiveParameters)) {
  for (int i = 0; i < count_; ++i) {
    lower_[i] = parameters[i].lower;
    upper_[i] = parameters[i].upper;
    rate_per_s_[i] = parameters[i].rate_per_s;
    initial_[i] = parameters[i].value;
  }
  reset();
}

void ParameterRamps::startAt(int index, double value) noexcept {
  if (index < 0 || index >= count_) return;
  if (value >= lower_[index] && value <= upper_[index]) initial_[index] = value;  // false for NaN
}

void ParameterRamps::reset() noexcept {
  value_ = wanted_ = initial_;
}

void ParameterRamps::ask(int index, double value) noexcept {
  if (index < 0 || index >= count_) return;
  if (value >= lower_[index] && value <= upper_[index]) wanted_[index] = value;  // false for NaN
}

void ParameterRamps::set(int index, double value) noexcept {
  if (index < 0 || index >= count_) return;
  if (value >= lower_[index] && value <= upper_[index]) value_[index] = wanted_[index] = value;
}

void ParameterRamps::advance(int elapsed_periods, double period_s) noexcept {
  for (int i = 0; i < count_; ++i) {
    const double most = rate_per_s_[i] * elapsed_periods * period_s;
    value_[i] += std::clamp(wanted_[i] - value_[i], -most, most);
  }
}

namespace {

constexpr double kLeastShare = 0.1;  // smallest share of a limit: a lower effort cannot be felt
constexpr double kRamp_s = 1.0;      // time of a ramp over the whole range

LiveParameter between(const char* name, const char* unit, double lower, double upper,
                      double value) {
  return {name, unit, lower, upper, value, (upper - lower) / kRamp_s};
}

LiveParameter limit(const char* name, double most_n) {
  LiveParameter parameter = between(name, "N", kLeastShare * most_n, most_n, most_n);
  parameter.bounds_effort = true;
  return parameter;
}

// f₀ of an axis in N. Translation: f₀ itself. Rotation with a tip: f₀ divided by its lever arm.
// Otherwise 0.
double fullInNewton(const DeviceAxis& axis, double effort_full) {
  if (axis.kind == AxisKind::kTranslation) return effort_full;
  return axis.lever_arm_m > 0.0 ? effort_full / axis.lever_arm_m : 0.0;
}

}  // namespace

LiveSettings::LiveSettings(const DeviceModel& device, const AdaptiveDampingConfig& damping)
    : hand_axis_(device.axisCount()), in_unit_(device.axisCount()) {
  // Largest force at a fingertip, on the arm, and f₀ of the first axis that has one in N.
  double tip_n = 0.0, arm_n = 0.0, full_n = 0.0;
  for (int i = 0; i < device.axisCount(); ++i) {
    const DeviceAxis& axis = device.axes[i];
    const bool hand = axis.group == AxisGroup::kHand;
    hand_axis_[i] = hand;
    if (axis.kind == AxisKind::kTranslation) in_unit_[i] = 1.0;
    if (hand && axis.kind == AxisKind::kRotation) in_unit_[i] = axis.lever_arm_m;
    if (in_unit_[i] > 0.0) {
      double& most = hand ? tip_n : arm_n;
      most = std::max(most, axis.effort_limit / in_unit_[i]);
    }
    if (full_n == 0.0) full_n = fullInNewton(axis, damping.effort_full[i]);
  }
  if (tip_n > 0.0) {
    add(Role::kHandLimit, limit("effort_limit_hand_tip_n", tip_n));
  }
  if (arm_n > 0.0) {
    add(Role::kArmLimit, limit("effort_limit_arm_n", arm_n));
  }
  if (full_n > 0.0) {
    add(Role::kDampingFull, between("damping_full_n", "N", 0.2 * full_n, 2.0 * full_n, full_n));
  }
  if (device.axisCount() > 0 && damping.decay_s[0] > 0.0) {
    const double decay_s = damping.decay_s[0];
    add(Role::kDampingDecay,
        between("damping_decay_s", "s", std::min(0.05, decay_s), std::max(1.0, decay_s), decay_s));
  }
}

void LiveSettings::add(Role role, LiveParameter parameter) {
  roles_.push_back(role);
  parameters_.push_back(std::move(parameter));
}

void LiveSettings::apply(const double* values, const AxisEffort& device_limit,
                         const AdaptiveDampingConfig& damping_at_start, AxisEffort& limit,
                         AdaptiveDampingConfig& damping) const noexcept {
  limit = device_limit;
  for (std::size_t p = 0; p < roles_.size(); ++p) {
    const double value = values[p];
    const LiveParameter& parameter = parameters_[p];
    for (int i = 0; i < device_limit.size(); ++i) {
      switch (roles_[p]) {
        case Role::kHandLimit:
        case Role::kArmLimit: {
          if (hand_axis_[i] != (roles_[p] == Role::kHandLimit)) break;
          if (value >= parameter.upper) break;  // at its upper end the device's own limit applies
          const double asked =
              in_unit_[i] > 0.0 ? value * in_unit_[i] : device_limit[i] * value / parameter.upper;
          limit[i] = std::min(device_limit[i], asked);
          break;
        }
        case Role::kDampingFull:
          damping.effort_full[i] = damping_at_start.effort_full[i] * (value / parameter.value);
          damping.effort_dead[i] = damping_at_start.effort_dead[i] * (value / parameter.value);
          break;
        case Role::kDampingDecay:
          damping.decay_s[i] = damping_at_start.decay_s[i] * (value / parameter.value);
          break;
      }
    }
  }
}

}  // namespace wholehand
