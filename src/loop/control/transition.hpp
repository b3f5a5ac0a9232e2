#pragma once

#include "loop/core/real_time.hpp"

namespace wholehand {

/// Fading of an exercise's effort in and out with the palm's distance from its target.
struct TransitionConfig {
  double engage_s = 1.0;    ///< T_on, > 0
  double release_s = 0.3;   ///< T_off, > 0
  double engage_m = 0.02;   ///< fades in when nearer than this
  double release_m = 0.03;  ///< fades out when farther; >= engage_m (hysteresis)
};

struct TransitionState {
  double u = 0.0;        ///< progress of the transition, 0 .. 1
  bool engaged = false;  ///< u rises to 1 or has reached it
};

/// α = 3u² − 2u³, Eq. (16) with corrected coefficients: 0 at u = 0, 1 at u = 1, zero slope at both.
[[nodiscard]] WHOLEHAND_RT double transitionAlpha(const TransitionState& state) noexcept;

/// Eq. (16) with u as a state, so that a reversal midway is continuous: u̇ = 1/T_on while engaged,
/// −1/T_off otherwise, clamped to [0, 1].
/// @param distance_m palm surface to the target; NaN and +inf disengage
/// @param allowed false: disengaged at any distance
/// @param elapsed_periods 1 + skipped periods. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT TransitionState advanceTransition(const TransitionState& state,
                                                             double distance_m, bool allowed,
                                                             const TransitionConfig& config,
                                                             int elapsed_periods,
                                                             double period_s) noexcept;

}  // namespace wholehand
