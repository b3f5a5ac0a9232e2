#pragma once

#include "core/real_time.hpp"

#include <cmath>

namespace wholehand {

/// Critical damping of a unit-mass PD controller under symplectic Euler, Eq. (14) [1/s]: both
/// closed-loop poles at 1 - T sqrt(k_p).
/// @pre kp_per_s2 * period_s^2 <= 1 (no ringing).  Real-time safe.
[[nodiscard]] WHOLEHAND_RT inline double criticalDamping(double kp_per_s2,
                                                         double period_s) noexcept {
  return 2.0 * std::sqrt(kp_per_s2) - kp_per_s2 * period_s;
}

}  // namespace wholehand
