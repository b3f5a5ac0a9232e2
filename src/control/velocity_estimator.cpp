#include "control/velocity_estimator.hpp"

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

}  // namespace wholehand
