#include "control/virtual_wall.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

double wallEffort(const VirtualWall& wall, double position, double velocity,
                  double alpha) noexcept {
  const double side = wall.closing < 0.0 ? -1.0 : 1.0;
  const double depth = side * (position - wall.position);
  const double push = wall.stiffness * depth + wall.damping * side * velocity;
  // The comparisons are false for NaN, so NaN gives no effort.
  if (!(depth > 0.0) || !(push > 0.0) || !(alpha > 0.0) || !(wall.effort_cap > 0.0)) return 0.0;
  if (!std::isfinite(depth) || !std::isfinite(push)) return 0.0;
  return -side * std::min(alpha, 1.0) * std::min(push, wall.effort_cap);
}

double transitionAlpha(const TransitionState& state) noexcept {
  return state.u * state.u * (3.0 - 2.0 * state.u);
}

TransitionState advanceTransition(const TransitionState& state, double distance_m, bool allowed,
                                  const TransitionConfig& config, int elapsed_periods,
                                  double period_s) noexcept {
  const double limit_m = state.engaged ? config.release_m : config.engage_m;
  const bool engaged = allowed && distance_m <= limit_m;  // false for NaN
  const double elapsed_s = std::max(elapsed_periods, 1) * period_s;
  const double rate_per_s = engaged ? 1.0 / config.engage_s : -1.0 / config.release_s;
  return {std::clamp(state.u + rate_per_s * elapsed_s, 0.0, 1.0), engaged};
}

}  // namespace wholehand
