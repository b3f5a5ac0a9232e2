#include "loop/control/transition.hpp"

#include <algorithm>

namespace wholehand {

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
