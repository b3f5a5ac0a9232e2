#pragma once

#include "loop/control/bilateral_coupling.hpp"

#include <cmath>
#include <numbers>

namespace wholehand::test {

/// Gains of one axis with an avatar inertia of k_pm / k_ps and a 30 Hz velocity filter.
inline CouplingGains oneAxisGains(double k_pm, double k_ps_per_s2, double gamma) {
  CouplingGains g;
  g.axes = 1;
  g.k_pm = AxisStiffness(1, k_pm);
  g.k_dm = AxisDamping(1, 0.0);
  g.gamma = AxisRatio(1, gamma);
  g.armature = AxisInertia(1, 0.0);
  g.inertia = AxisInertia(1, k_pm / k_ps_per_s2);
  g.filter_tau_s = AxisTime(1, 1.0 / (2.0 * std::numbers::pi * 30.0));
  return g;
}

/// D of one axis at its reference, by Eq. (14) written out.
inline AxisDamping dampingOf(const CouplingGains& g, double period_s = 1e-3) {
  return AxisDamping(1, 2.0 * std::sqrt(g.k_pm[0] * g.inertia[0]) - period_s * g.k_pm[0]);
}

}  // namespace wholehand::test
