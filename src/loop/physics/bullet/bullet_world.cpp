#include "loop/physics/bullet/bullet_world.hpp"

#include "loop/physics/bullet/bullet_engine.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/physics_world.hpp"

#include <LinearMath/btAlignedAllocator.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace wholehand::bullet {
namespace {

void* allocate(std::size_t bytes) {
  void* memory = std::malloc(bytes);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void useCheckedMemory() {
  // Set only once: Bullet keeps the two functions in plain variables, and another thread may be
  // using them.
  static const bool kOnce = (btAlignedAllocSetCustom(allocate, std::free), true);
  (void)kOnce;
}

}  // namespace wholehand::bullet

namespace wholehand {

using bullet::toVec3;

BulletWorld::BulletWorld(const HandModel& hand, const SceneModel& scene,
                         const BulletSettings& settings) {
  bullet::useCheckedMemory();
  engine_ = std::make_unique<bullet::BulletEngine>(hand, scene, settings);
}

BulletWorld::~BulletWorld() = default;

Expected<Done> BulletWorld::placeHand(const AxisPosition& q_s) {
  bullet::BulletEngine& e = *engine_;
  for (std::size_t i = 0; i < e.bodies.size(); ++i) {
    if (allFinite(e.bodies[i].state())) continue;
    return nonFiniteBodyError(e.scene_path, e.body_names[i]);
  }
  e.forgetContacts();
  e.setHand(q_s, AxisVelocity(e.hand_model.axis_count));
  e.rows.reset(e.kinematics, q_s);
  e.solver.forgetStep();
  Diagnostics found = e.overlaps();
  if (!found.empty()) return found;
  return Done{};
}

Fault BulletWorld::observe(PhysicsState& state) noexcept {
  bullet::BulletEngine& e = *engine_;
  state.q_s = e.q_s;
  state.qd_s = e.qd_s;
  state.theta = e.theta;
  state.theta_dot = e.theta_dot;
  state.kinematics = &e.kinematics;
  state.coupling_error_rad = 0.0;  // the joints are computed as θ₀ + G q_s, so there is no error
  state.body_count = std::min(static_cast<int>(e.bodies.size()), kMaxBodies);
  bool finite = allFinite(state.q_s) && allFinite(state.qd_s);
  const std::vector<BodyState>& bodies = e.bodyStates();
  std::copy(bodies.begin(), bodies.end(), state.bodies.begin());
  state.body_joint_count = 0;
  for (const int body : e.on_joints) {
    const int joint = state.body_joint_count++;
    state.body_q[joint] = e.bodies[body].jointPosition();
    state.body_qd[joint] = e.bodies[body].jointRate();
  }
  for (const int body : e.resting.awakeBodies()) {
    finite = finite && allFinite(body < state.body_count ? bodies[body] : e.bodies[body].state());
  }
  return finite ? Fault::kNone : Fault::kNonFiniteState;
}

void BulletWorld::placeBodies(const BodyPlacements& placements) noexcept {
  for (int i = 0; i < placements.count; ++i) {
    const BodyPlacement& placement = placements.items[i];
    if (placement.body < 0 || placement.body >= static_cast<int>(engine_->bodies.size())) continue;
    if (engine_->bodies[placement.body].place(placement)) {
      engine_->forgetContacts(placement.body);
    }
    engine_->pairs.placed(placement.body);
    engine_->updateState(placement.body);
  }
}

Fault BulletWorld::step(const HandDrive& drive, double period_s) noexcept {
  bullet::BulletEngine& e = *engine_;
  if (drive.reduced_inertia_inverse == nullptr || drive.effort.size() != e.qd_s.size()) {
    return Fault::kPhysicsStep;
  }
  e.period_s = period_s;
  // Under τ = M G M_r⁻¹ f_s + h the joints accelerate by G M_r⁻¹ f_s and keep the synergy.
  // Therefore only its few coordinates are integrated, by symplectic Euler like Bullet's bodies.
  AxisVelocity qd_s = e.qd_s;
  for (int a = 0; a < qd_s.size(); ++a) {
    for (int b = 0; b < qd_s.size(); ++b) {
      qd_s[a] += period_s * (*drive.reduced_inertia_inverse)(b, a) * drive.effort[b];
    }
  }
  e.solver.beginStep(*drive.reduced_inertia_inverse, qd_s);
  e.rows.beginStep(e.kinematics, e.q_s);
  e.beginStep();
  e.advance(period_s);

  qd_s = e.solver.velocity();
  AxisPosition q_s = e.q_s;
  for (int a = 0; a < qd_s.size(); ++a) q_s[a] += period_s * qd_s[a];
  if (!allFinite(q_s) || !allFinite(qd_s)) return Fault::kNonFiniteState;
  e.setHand(q_s, qd_s);
  return e.solver.unsettled() ? Fault::kContactsUnsettled : Fault::kNone;
}

void BulletWorld::apply(const Command& command) noexcept {
  engine_->game.apply(command);
}

void BulletWorld::setGameAlive(bool alive) noexcept {
  engine_->game.setGameAlive(alive);
}

void BulletWorld::report(PoolReport& report) noexcept {
  engine_->game.report(report);
}

void BulletWorld::contacts(ContactList& contacts) const noexcept {
  const bullet::BulletEngine& e = *engine_;
  contacts.count = 0;
  // Counts the points that the solver dropped and the pairs that never reached it.
  contacts.dropped = e.solver.dropped() + e.dropped();
  for (int i = 0; i < e.solver.contactCount(); ++i) {
    const bullet::HandContact& c = e.solver.contact(i);
    if (c.normal_row.impulse <= 0.0) continue;
    if (contacts.count == kMaxContacts) {
      ++contacts.dropped;
      continue;
    }
    Contact& out = contacts.points[contacts.count++];
    const double per_s = 1.0 / e.period_s;
    out.capsule = c.capsule;
    out.link = e.hand_model.capsules[c.capsule].link;
    out.body = c.body;
    out.point_m = toVec3(c.on_hand);
    out.normal = toVec3(c.normal);
    out.force_n = toVec3((c.normal * c.normal_row.impulse + c.tangent1 * c.tangent1_row.impulse +
                          c.tangent2 * c.tangent2_row.impulse) *
                         per_s);
    out.torque_nm = toVec3(c.normal * (c.spin_row.impulse * per_s));
    out.distance_m = c.distance_m;
  }
}

void BulletWorld::selfForces(SelfForces& forces) const noexcept {
  const bullet::BulletEngine& e = *engine_;
  const double per_s = 1.0 / e.period_s;
  forces.count = 0;
  for (int i = 0; i < e.rows.touchCount() && forces.count < kMaxSelfForces; ++i) {
    const bullet::SelfTouch& touch = e.rows.touch(i);
    if (touch.normal_row.impulse <= 0.0) continue;
    const SelfPair& pair = e.hand_model.self_contacts[touch.pair];
    const Eigen::Vector3d impulse = touch.gap.normal * touch.normal_row.impulse +
                                    touch.tangent1 * touch.tangent1_row.impulse +
                                    touch.tangent2 * touch.tangent2_row.impulse;
    forces.touches[forces.count++] = {pair.capsule_a,
                                      pair.capsule_b,
                                      Vec3::from(touch.gap.point_m),
                                      Vec3::from(touch.gap.normal),
                                      Vec3::from(impulse * per_s),
                                      touch.gap.distance_m};
  }
  forces.joint_ends = e.rows.endImpulse();
  for (int a = 0; a < forces.joint_ends.size(); ++a) forces.joint_ends[a] *= per_s;
}

}  // namespace wholehand
