#include "loop/control/corridor.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

bool same(const MovementGoal& a, const MovementGoal& b) noexcept {
  return a.known == b.known && a.movement == b.movement && a.at_m.x == b.at_m.x &&
         a.at_m.y == b.at_m.y && a.at_m.z == b.at_m.z;
}

/// A goal within the corridor's radius leaves no way to go straight.
bool hasWay(const MovementGoal& goal, const Eigen::Vector3d& hand_m, double radius_m) noexcept {
  const Eigen::Vector3d way_m = goal.at_m.eigen() - hand_m;
  return goal.known && way_m.allFinite() && way_m.norm() > radius_m;
}

Eigen::Vector3d offsetFrom(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::Vector3d& at) noexcept {
  const Eigen::Vector3d way = b - a;
  const double along = std::clamp(way.dot(at - a) / way.squaredNorm(), 0.0, 1.0);
  return at - a - along * way;
}

}  // namespace

CorridorState advanceCorridor(const CorridorState& state, const CorridorConfig& config,
                              const Eigen::Vector3d& hand_m, const MovementGoal& goal, bool allowed,
                              double elapsed_s) noexcept {
  CorridorState out = state;
  if (out.scale > 0.0) {
    out.falls = out.falls || !allowed || !same(goal, out.goal);
    if (out.falls) out.scale = std::max(0.0, out.scale - elapsed_s / CorridorConfig::kFall_s);
  }
  if (out.scale > 0.0) return out;
  out = CorridorState{};
  if (allowed && hasWay(goal, hand_m, config.radius_m)) {
    out.scale = 1.0;
    out.goal = goal;
    out.from_m = hand_m;
  }
  return out;
}

CorridorPush pushOfCorridor(const CorridorState& state, const CorridorConfig& config,
                            const Eigen::Vector3d& hand_m) noexcept {
  CorridorPush out;
  if (!(state.scale > 0.0)) return out;
  const Eigen::Vector3d e_m = offsetFrom(state.from_m, state.goal.at_m.eigen(), hand_m);
  const double outside_m = e_m.norm() - config.radius_m;
  if (!(outside_m > 0.0)) return out;
  const double most_m = config.most_n / config.stiffness_n_m;
  const double pressed_m = std::min(outside_m, most_m);
  out.direction = e_m / e_m.norm();
  out.force_n = -state.scale * config.stiffness_n_m * pressed_m * out.direction;
  out.stored_j = state.scale * config.stiffness_n_m * pressed_m * (outside_m - 0.5 * pressed_m);
  return out;
}

}  // namespace wholehand
