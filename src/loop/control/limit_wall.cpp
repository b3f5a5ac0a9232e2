#include "loop/control/limit_wall.hpp"

#include <algorithm>

namespace wholehand {
namespace {

constexpr double kBehind = 0.5;  ///< distance at which a wall follows the hand home [bands]

/// ∫ min(k p, most) dp, from 0 to p.
double storedAt(double p, double stiffness, double most) noexcept {
  if (stiffness * p <= most) return 0.5 * stiffness * p * p;
  return most * p - 0.5 * most * most / stiffness;
}

}  // namespace

LimitWallState placeLimitWalls(const LimitWallConfig& config, const AxisPosition& q) noexcept {
  LimitWallState out{AxisPosition(config.axes), AxisPosition(config.axes)};
  for (int a = 0; a < config.axes; ++a) {
    out.lower[a] = std::min(config.lower[a] + config.band[a], q[a]);
    out.upper[a] = std::max(config.upper[a] - config.band[a], q[a]);
  }
  return out;
}

LimitWallState followHome(const LimitWallState& state, const LimitWallConfig& config,
                          const AxisPosition& q) noexcept {
  LimitWallState out = state;
  for (int a = 0; a < config.axes; ++a) {
    const double band = config.band[a], behind = kBehind * band;
    out.lower[a] = std::max(state.lower[a], std::min(config.lower[a] + band, q[a] - behind));
    out.upper[a] = std::min(state.upper[a], std::max(config.upper[a] - band, q[a] + behind));
  }
  return out;
}

LimitPush pushOfLimit(const LimitWallState& state, const LimitWallConfig& config, int axis,
                      double q) noexcept {
  const double stiffness = config.stiffness[axis], most = config.most[axis];
  const double above = q - state.upper[axis], below = state.lower[axis] - q;
  const double p = std::max(above, below);
  if (!(stiffness > 0.0) || !(p > 0.0)) return {};
  const double effort = std::min(stiffness * p, most);
  return {above > below ? -effort : effort, storedAt(p, stiffness, most)};
}

}  // namespace wholehand
