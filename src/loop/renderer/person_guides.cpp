#include "loop/renderer/person_guides.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

/// x, y or z of a vector.
double& component(Vec3& v, int i) noexcept {
  return i == 0 ? v.x : i == 1 ? v.y : v.z;
}

}  // namespace

PersonGuides::PersonGuides(const PersonGuidesConfig& config) : config_(config) {
  begin(AxisPosition(config_.walls.axes));
}

void PersonGuides::begin(const AxisPosition& q_m) noexcept {
  walls_ = placeLimitWalls(config_.walls, q_m);
  scale_ = 1.0;
  corridor_ = CorridorState{};
  exercise_edge_ = AxisEffort(config_.walls.axes);
  clear();
}

void PersonGuides::clear() noexcept {
  effort_ = AxisEffort(config_.walls.axes);
  stored_j_ = AxisEnergy(config_.walls.axes);
}

void PersonGuides::advance(const AxisPosition& q_m, const MovementGoal& goal, bool allowed,
                           double elapsed_s) noexcept {
  clear();
  if (!allowed || scale_ < 1.0) {
    scale_ = std::max(0.0, scale_ - elapsed_s / CorridorConfig::kFall_s);
    if (allowed && scale_ <= 0.0) {
      walls_ = placeLimitWalls(config_.walls, q_m);
      scale_ = 1.0;
    }
  }
  walls_ = followHome(walls_, config_.walls, q_m);
  for (int a = 0; a < config_.walls.axes; ++a) {
    const LimitPush push = pushOfLimit(walls_, config_.walls, a, q_m[a]);
    effort_[a] = scale_ * push.effort;
    stored_j_[a] = scale_ * push.stored_j;
  }
  if (config_.corridor) pushByCorridor(q_m, goal, allowed, elapsed_s);
}

void PersonGuides::pushByCorridor(const AxisPosition& q_m, const MovementGoal& goal, bool allowed,
                                  double elapsed_s) noexcept {
  const Eigen::Vector3d hand_m = placeOf(q_m);
  corridor_ =
      advanceCorridor(corridor_, *config_.corridor, hand_m, reachable(goal), allowed, elapsed_s);
  const CorridorPush push = pushOfCorridor(corridor_, *config_.corridor, hand_m);
  for (int i = 0; i < 3; ++i) {
    const int axis = config_.translations[i];
    if (axis < 0) continue;
    effort_[axis] += push.force_n[i];
    stored_j_[axis] += push.direction[i] * push.direction[i] * push.stored_j;
  }
}

Eigen::Vector3d PersonGuides::placeOf(const AxisPosition& q_m) const noexcept {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    if (config_.translations[i] >= 0) out[i] = q_m[config_.translations[i]];
  }
  return out;
}

/// The goal without the axes that the device lacks; none when a limit's band or more lies before
/// it.
MovementGoal PersonGuides::reachable(const MovementGoal& goal) const noexcept {
  MovementGoal out = goal;
  for (int i = 0; i < 3; ++i) {
    const int axis = config_.translations[i];
    double& at_m = component(out.at_m, i);
    if (axis < 0) at_m = 0.0;
    if (axis >= 0 && !withinBands(axis, at_m)) out.known = false;
  }
  return out;
}

bool PersonGuides::withinBands(int axis, double q) const noexcept {
  const LimitWallConfig& walls = config_.walls;
  return q >= walls.lower[axis] + walls.band[axis] && q <= walls.upper[axis] - walls.band[axis];
}

void PersonGuides::boundExercise(const AxisPosition& q_m, ExerciseRecord& exercise) noexcept {
  for (int a = 0; a < config_.walls.axes; ++a) {
    double& effort = exercise.effort[a];
    if (withinBands(a, q_m[a])) {
      exercise_edge_[a] = std::abs(effort);
    } else {
      effort = std::clamp(effort, -exercise_edge_[a], exercise_edge_[a]);
    }
  }
}

}  // namespace wholehand
