#include "control/bilateral_coupling.hpp"

#include <algorithm>

namespace wholehand {

VelocityState estimateVelocity(const VelocityState& state, const AxisPosition& q_m,
                               const CouplingGains& gains, int elapsed_periods,
                               double period_s) noexcept {
  VelocityState next;
  next.previous = q_m;
  next.filtered = AxisVelocity(gains.axes);
  next.started = true;
  if (!state.started) return next;
  const double elapsed_s = std::max(elapsed_periods, 1) * period_s;
  for (int i = 0; i < gains.axes; ++i) {
    const double tau_s = gains.filter_tau_s[i];
    next.filtered[i] =
        (tau_s * state.filtered[i] + (q_m[i] - state.previous[i])) / (tau_s + elapsed_s);
  }
  return next;
}

AxisEffort avatarEffort(const AxisPosition& q_m, const AxisVelocity& qd_mf, const AxisPosition& q_s,
                        const AxisVelocity& qd_s, const AxisDamping& avatar_damping,
                        const CouplingGains& gains) noexcept {
  AxisEffort f_s(gains.axes);
  for (int i = 0; i < gains.axes; ++i) {
    f_s[i] = gains.k_pm[i] * (q_m[i] - q_s[i]) + avatar_damping[i] * (qd_mf[i] - qd_s[i]);
  }
  return f_s;
}

AxisEffort couplingEffort(const AxisPosition& q_m, const AxisVelocity& qd_mf,
                          const AxisPosition& q_s, const AxisVelocity& qd_s,
                          const AxisDamping& avatar_damping, const CouplingGains& gains) noexcept {
  AxisEffort f(gains.axes);
  for (int i = 0; i < gains.axes; ++i) {
    f[i] = gains.k_pm[i] * (q_s[i] - q_m[i]) +
           gains.gamma[i] * avatar_damping[i] * (qd_s[i] - qd_mf[i]);
  }
  return f;
}

}  // namespace wholehand
