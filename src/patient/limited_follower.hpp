#pragma once

#include "core/real_time.hpp"

namespace wholehand {

/// Limits of an axis that follows a moving point.
struct FollowerLimits {
  double lower = 0.0, upper = 0.0;  ///< the point is clamped to this range [m or rad]
  double speed = 1.0;               ///< largest speed of the goal [m/s or rad/s], > 0
  double rate_rad_s = 20.0;         ///< bandwidth of the filter; lag 2 / rate, > 0
};

/// State of the follower. `goal` approaches the point at the speed limit; position and velocity
/// follow it.
struct FollowerState {
  double position = 0.0, velocity = 0.0, goal = 0.0;
};

/// State that continues at this speed. The goal lies ahead such that the acceleration begins at
/// zero. Real-time safe.
[[nodiscard]] WHOLEHAND_RT FollowerState movingFollower(double position, double velocity,
                                                        const FollowerLimits& limits) noexcept;

/// One period of q̈ = ω² (goal − q) − 2 ω q̇, exact for a goal constant over the period. The
/// impulse response is non-negative and sums to one: it never overshoots a goal and is never faster
/// than the goal, or than itself at the start. Real-time safe.
[[nodiscard]] WHOLEHAND_RT FollowerState follow(FollowerState state, double point,
                                                const FollowerLimits& limits,
                                                double period_s) noexcept;

}  // namespace wholehand
