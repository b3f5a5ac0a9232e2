#pragma once

#include "control/coupling_gains.hpp"
#include "control/critical_damping.hpp"

#include <numbers>

namespace wholehand::test {

/// Gains of one axis at σ = 1, Eq. (14) and a 30 Hz velocity filter.
inline CouplingGains oneAxisGains(double k_pm, double k_ps_per_s2, double gamma,
                                  double period_s = 1e-3) {
  CouplingGains g;
  g.axes = 1;
  g.k_pm = AxisRatio(1, k_pm);
  g.k_dm = AxisRatio(1, 0.0);
  g.gamma = AxisRatio(1, gamma);
  g.k_ps_per_s2 = AxisRatio(1, k_ps_per_s2);
  g.k_ds_per_s = AxisRatio(1, criticalDamping(k_ps_per_s2, period_s));
  g.relative_damping = AxisRatio(1, k_pm * g.k_ds_per_s[0] / k_ps_per_s2);
  g.filter_tau_s = AxisRatio(1, 1.0 / (2.0 * std::numbers::pi * 30.0));
  g.contact_scale = AxisRatio(1, 1.0);
  return g;
}

}  // namespace wholehand::test
