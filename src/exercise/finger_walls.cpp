#include "exercise/finger_walls.hpp"

#include "control/virtual_wall.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

/// Where the wall is next; only called where the closure is finite.
double follow(double wall, bool known, double target, double finger, double alpha,
              double reach) noexcept {
  if (!(alpha > 0.0)) return target;
  if (!known) return std::max(target, finger);  // nobody is to find himself inside a wall
  return wall + std::clamp(target - wall, -reach, reach);
}

}  // namespace

FingerWallState followClosure(const FingerWallState& state, const AxisPosition& closure,
                              const AxisPosition& q_m, double lead_in_m, double alpha,
                              const FingerWallConfig& config, double elapsed_s) noexcept {
  FingerWallState next{AxisPosition(config.axes), AxisRatio(config.axes)};
  for (int i = 0; i < config.axes; ++i) {
    if (!(config.stiffness[i] > 0.0) && !(config.damping[i] > 0.0)) continue;
    const bool known = i < state.known.size() && state.known[i] > 0.0;
    if (i < closure.size() && std::isfinite(closure[i])) {
      const double target = closure[i] - lead_in_m / config.lever_arm_m[i];
      next.known[i] = 1.0;
      next.position[i] = follow(known ? state.position[i] : 0.0, known, target, q_m[i], alpha,
                                config.follow_m_s / config.lever_arm_m[i] * elapsed_s);
    } else if (known && alpha > 0.0) {
      next.known[i] = 1.0;
      next.position[i] = state.position[i];
    }
  }
  return next;
}

AxisEffort fingerWallEffort(const FingerWallState& state, const AxisPosition& q_m,
                            const AxisVelocity& qd_mf, double alpha, const WallRatios& ratios,
                            const FingerWallConfig& config) noexcept {
  AxisEffort effort(config.axes);
  for (int i = 0; i < config.axes; ++i) {
    if (!(state.known[i] > 0.0)) continue;
    const VirtualWall wall{state.position[i], 1.0, ratios.stiffness * config.stiffness[i],
                           ratios.damping * config.damping[i], config.effort_cap[i]};
    effort[i] = wallEffort(wall, q_m[i], qd_mf[i], alpha);
  }
  return effort;
}

}  // namespace wholehand
