#include "loop/control/adaptive_damping.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

namespace {

/// ρ of Algorithm 1 with the dead band. The comparisons let NaN lead to more damping.
double activation(double effort, double effort_dead, double effort_full) noexcept {
  if (!std::isfinite(effort)) return 1.0;
  const double magnitude = std::abs(effort);
  if (!(effort_full > effort_dead)) return magnitude <= effort_dead ? 0.0 : 1.0;
  return std::clamp((magnitude - effort_dead) / (effort_full - effort_dead), 0.0, 1.0);
}

}  // namespace

double activate(double phi, double effort, double effort_dead, double effort_full, double decay_s,
                int elapsed_periods, double period_s) noexcept {
  const double rho = activation(effort, effort_dead, effort_full);
  const double elapsed_s = std::max(elapsed_periods, 1) * period_s;
  const double kept = decay_s > 0.0 ? std::exp(-elapsed_s / decay_s) : 0.0;
  const double decayed = kept * phi;
  return decayed > rho ? std::min(decayed, 1.0) : rho;  // a NaN φ is discarded
}

AdaptiveDampingConfig makeAdaptiveDamping(const DeviceModel& device,
                                          const RenderingConfig& rendering) {
  const int n = device.axisCount();
  AdaptiveDampingConfig config{n,           AxisEffort(n), AxisEffort(n),
                               AxisTime(n), AxisFlag(n),   AxisFlag(n)};
  for (int i = 0; i < n; ++i) {
    const AxisRendering& axis = rendering.axes[i];
    config.effort_dead[i] = axis.effort_dead;
    config.effort_full[i] = axis.effort_full;
    config.decay_s[i] = axis.decay_s;
    config.hand_axis[i] = device.axes[i].group == AxisGroup::kHand;
    config.palm_contact[i] = axis.palm_contact;
  }
  return config;
}

AdaptiveDampingState adaptDamping(const AdaptiveDampingState& state, const AxisEffort& effort,
                                  const AdaptiveDampingConfig& config, int elapsed_periods,
                                  double period_s) noexcept {
  AdaptiveDampingState next{AxisRatio(config.axes), AxisRatio(config.axes)};
  bool any_hand_axis = false;
  double hand_phi = 0.0;
  for (int i = 0; i < config.axes; ++i) {
    const double before = i < state.own.size() ? state.own[i] : 0.0;
    next.own[i] = activate(before, effort[i], config.effort_dead[i], config.effort_full[i],
                           config.decay_s[i], elapsed_periods, period_s);
    if (config.hand_axis[i]) {
      any_hand_axis = true;
      hand_phi = std::max(hand_phi, next.own[i]);
    }
  }
  for (int i = 0; i < config.axes; ++i) {
    if (config.hand_axis[i] || !any_hand_axis) {
      next.phi[i] = next.own[i];
    } else {
      next.phi[i] = config.palm_contact[i] ? std::max(hand_phi, next.own[i]) : hand_phi;
    }
  }
  return next;
}

}  // namespace wholehand
