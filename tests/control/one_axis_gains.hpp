#pragma once

#include "control/coupling_gains.hpp"

#include <cmath>
#include <numbers>

namespace wholehand::test {

/// Gains of one axis whose avatar weighs k_pm / k_ps, and a 30 Hz velocity filter.
inline CouplingGains oneAxisGains(double k_pm, double k_ps_per_s2, double gamma) {
  CouplingGains g;
  g.axes = 1;
  g.k_pm = AxisRatio(1, k_pm);
  g.k_dm = AxisRatio(1, 0.0);
  g.gamma = AxisRatio(1, gamma);
  g.armature = AxisRatio(1, 0.0);
  g.inertia = AxisRatio(1, k_pm / k_ps_per_s2);
  g.filter_tau_s = AxisRatio(1, 1.0 / (2.0 * std::numbers::pi * 30.0));
  return g;
}

/// D of one axis at its reference, by Eq. (14) spelt out.
inline AxisRatio dampingOf(const CouplingGains& g, double period_s = 1e-3) {
  return AxisRatio(1, 2.0 * std::sqrt(g.k_pm[0] * g.inertia[0]) - period_s * g.k_pm[0]);
}

}  // namespace wholehand::test
