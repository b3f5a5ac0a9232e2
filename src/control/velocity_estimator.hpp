#pragma once

#include "control/coupling_gains.hpp"
#include "core/axis_array.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// State of the velocity estimator.
struct VelocityState {
  AxisPosition previous;
  AxisVelocity filtered;  ///< q̇_m,f
  bool started = false;
};

/// Backward difference over the elapsed time, then a first-order low-pass discretised by backward
/// Euler (paper §II-C): v_f ← (τ v_f + Δq) / (τ + kT). The first call yields zero velocity.
/// @param elapsed_periods 1 + skipped periods. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT VelocityState estimateVelocity(const VelocityState& state,
                                                          const AxisPosition& q_m,
                                                          const CouplingGains& gains,
                                                          int elapsed_periods,
                                                          double period_s) noexcept;

}  // namespace wholehand
