#include "patient/limited_follower.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

FollowerState movingFollower(double position, double velocity,
                             const FollowerLimits& limits) noexcept {
  return {position, velocity, position + 2.0 * velocity / limits.rate_rad_s};
}

FollowerState follow(FollowerState state, double point, const FollowerLimits& limits,
                     double period_s) noexcept {
  const double most = limits.speed * period_s;
  const double wanted = std::clamp(point, limits.lower, limits.upper);
  state.goal += std::clamp(wanted - state.goal, -most, most);
  const double w = limits.rate_rad_s;
  const double fade = std::exp(-w * period_s);
  const double error = state.position - state.goal;
  const double push = state.velocity + w * error;
  state.position = state.goal + (error + push * period_s) * fade;
  state.velocity = (state.velocity - w * push * period_s) * fade;
  return state;
}

}  // namespace wholehand
