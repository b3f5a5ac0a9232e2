#pragma once

#include "core/real_time.hpp"

namespace wholehand {

/// How one axis follows a point that somebody moves about.
struct FollowerLimits {
  double lower = 0.0, upper = 0.0;  ///< the point is held inside [m or rad]
  double speed = 1.0;               ///< the point moves no faster [m/s or rad/s], > 0
  double rate_rad_s = 20.0;         ///< of the filter; it is 2 / rate behind, > 0
};

/// Where it is. `goal` moves towards the point at the speed limit; the rest follows it.
struct FollowerState {
  double position = 0.0, velocity = 0.0, goal = 0.0;
};

/// A state that goes on at this speed: the goal lies as far ahead as that asks for, so that the
/// acceleration begins at zero. Real-time safe.
[[nodiscard]] WHOLEHAND_RT FollowerState movingFollower(double position, double velocity,
                                                        const FollowerLimits& limits) noexcept;

/// One period: q̈ = ω² (goal − q) − 2 ω q̇, the exact solution for a goal that stands still over the
/// period. Its response is nowhere negative and adds up to one: it never overshoots a goal, and is
/// never faster than the goal was, or itself at the start. Real-time safe.
[[nodiscard]] WHOLEHAND_RT FollowerState follow(FollowerState state, double point,
                                                const FollowerLimits& limits,
                                                double period_s) noexcept;

}  // namespace wholehand
