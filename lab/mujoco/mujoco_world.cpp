#include "lab/mujoco/mujoco_world.hpp"

#include "lab/mujoco/mujoco_engine.hpp"
#include "loop/physics/physics_world.hpp"

#include <algorithm>
#include <utility>

namespace wholehand {

Expected<std::unique_ptr<PhysicsWorld>> MujocoWorld::build(const HandModel& hand,
                                                           const SceneModel& scene,
                                                           const MujocoSettings& settings) {
  auto engine = mujoco::MujocoEngine::build(hand, scene, settings);
  if (!engine) return engine.errors();
  return std::unique_ptr<PhysicsWorld>(new MujocoWorld(hand, std::move(*engine)));
}

MujocoWorld::MujocoWorld(const HandModel& hand, std::unique_ptr<mujoco::MujocoEngine> engine)
    : hand_(&hand), synergy_(hand), engine_(std::move(engine)) {}

MujocoWorld::~MujocoWorld() = default;

Expected<Done> MujocoWorld::placeHand(const AxisPosition& q_s) {
  for (int i = 0; i < std::min(engine_->bodyCount(), kMaxBodies); ++i) {
    if (allFinite(engine_->body(i))) continue;
    return nonFiniteBodyError(engine_->scenePath(), engine_->bodyNames()[i]);
  }
  Diagnostics found = engine_->placeHand(q_s);
  if (!found.empty()) return found;
  return Done{};
}

Fault MujocoWorld::observe(PhysicsState& state) noexcept {
  state.q_s = engine_->q_s;
  state.qd_s = engine_->qd_s;
  synergy_.expand(state.q_s, state.theta);
  state.theta_dot = JointVelocity(hand_->joint_count);
  synergy_.expandRate(state.qd_s.data(), state.theta_dot.data());
  state.coupling_error_rad = engine_->coupling_error_rad;
  state.body_count = engine_->bodyCount();
  bool finite = allFinite(state.q_s) && allFinite(state.qd_s);
  for (int i = 0; i < state.body_count; ++i) {
    BodyState& body = state.bodies[i];
    body = engine_->body(i);
    finite = finite && allFinite(body);
  }
  return finite ? Fault::kNone : Fault::kNonFiniteState;
}

void MujocoWorld::placeBodies(const BodyPlacements& placements) noexcept {
  for (int i = 0; i < placements.count; ++i) {
    engine_->place(placements.items[i]);
  }
}

Fault MujocoWorld::step(const HandDrive& drive, double period_s) noexcept {
  if (drive.torque.size() != hand_->joint_count || !allFinite(drive.torque)) {
    return Fault::kPhysicsStep;
  }
  if (!engine_->step(drive, period_s)) return Fault::kPhysicsStep;
  return allFinite(engine_->q_s) ? Fault::kNone : Fault::kNonFiniteState;
}

void MujocoWorld::contacts(ContactList& contacts) const noexcept {
  engine_->contacts(contacts);
}

void MujocoWorld::selfForces(SelfForces& forces) const noexcept {
  engine_->selfForces(forces);
}

}  // namespace wholehand
