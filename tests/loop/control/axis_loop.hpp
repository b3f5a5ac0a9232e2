#pragma once

#include "certify/stability.hpp"
#include "loop/control/bilateral_coupling.hpp"

#include <complex>
#include <numbers>

namespace wholehand::test {

using Complex = std::complex<double>;

inline constexpr double kSide =
    0.02;  ///< relative distance to a boundary at which a test looks at both sides

/// One axis at 1 kHz without a person, K_ds by Eq. (14). @param filter_hz of the velocity; 0: no
/// filter
inline AxisLoop loopOf(double mass, double damping, int delay_ticks, double k_pm, double phi_k_dm,
                       double filter_hz, double k_ps_per_s2 = 2500.0, double gamma = 0.0) {
  AxisLoop l;
  l.mass = mass;
  l.damping = damping;
  l.delay_ticks = delay_ticks;
  l.k_pm = k_pm;
  l.phi_k_dm = phi_k_dm;
  l.gamma = gamma;
  l.k_ps_per_s2 = k_ps_per_s2;
  l.k_ds_per_s = criticalDamping(k_ps_per_s2, l.period_s);
  l.filter_tau_s = filter_hz > 0.0 ? 1.0 / (2.0 * std::numbers::pi * filter_hz) : 0.0;
  return l;
}

}  // namespace wholehand::test
