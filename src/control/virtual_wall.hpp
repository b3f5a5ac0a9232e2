#pragma once

#include "core/real_time.hpp"

namespace wholehand {

/// A wall on one axis. Stiffness in [N/m or N·m/rad], damping in [N·s/m or N·m·s/rad].
struct VirtualWall {
  double position = 0.0;    ///< θ_wall [m or rad]
  double closing = 1.0;     ///< s: +1 where closing raises the coordinate, -1 where it lowers it
  double stiffness = 0.0;   ///< k
  double damping = 0.0;     ///< d
  double effort_cap = 0.0;  ///< upper limit of max(0, k p + d ṗ) [N or N·m]
};

/// Eq. (15) with corrected signs (docs/equations.md): with p = s (θ − θ_wall),
///   f_e = −s α min(cap, max(0, k p + d ṗ_f)) where p > 0, else 0.
/// The wall never pulls: s f_e <= 0 for any input. Non-finite input gives 0.
/// @param position device coordinate θ @param velocity its filtered velocity
/// @param alpha of the transition, 0 .. 1. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT double wallEffort(const VirtualWall& wall, double position,
                                             double velocity, double alpha) noexcept;

/// Fading of an exercise's effort in and out with the palm's distance from its target.
struct TransitionConfig {
  double engage_s = 1.0;    ///< T_on, > 0
  double release_s = 0.3;   ///< T_off, > 0
  double engage_m = 0.02;   ///< fades in when nearer than this
  double release_m = 0.03;  ///< fades out when farther; >= engage_m (hysteresis)
};

struct TransitionState {
  double u = 0.0;        ///< progress of the transition, 0 .. 1
  bool engaged = false;  ///< u rises to 1 or is there
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
