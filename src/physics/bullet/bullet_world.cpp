#include "physics/bullet/bullet_world.hpp"

#include "physics/bullet/bullet_engine.hpp"
#include "physics/bullet/bullet_types.hpp"

#include <array>

namespace wholehand {

using bullet::toVec3;

namespace {

bool allFinite(const BodyState& body) {
  return body.position_m.eigen().allFinite() && body.velocity_m_s.eigen().allFinite() &&
         body.angular_velocity_rad_s.eigen().allFinite() &&
         body.orientation_xyzw.eigen().coeffs().allFinite();
}

}  // namespace

BulletWorld::BulletWorld(const HandModel& hand, const SceneModel& scene,
                         const BulletSettings& settings)
    : engine_(std::make_unique<bullet::BulletEngine>(hand, scene, settings)) {}

BulletWorld::~BulletWorld() = default;

Expected<Done> BulletWorld::placeHand(const AxisPosition& q_s) {
  bullet::BulletEngine& e = *engine_;
  for (std::size_t i = 0; i < e.bodies.size(); ++i) {
    if (allFinite(e.bodies[i].state())) continue;
    return Diagnostic{
        e.scene_path,          0, "bodies." + e.body_names[i], "", "is nowhere after a fault",
        "build the scene anew"};
  }
  e.forgetContacts();
  JointPosition theta;
  e.synergy.expand(q_s, theta);
  const std::array<double, kMaxJoints> at_rest{};
  e.setHand(theta, at_rest.data());
  e.coupling_error_rad = 0.0;
  e.axis_closure.reset();
  e.q_s = q_s;
  e.rows.reset(e.kinematics, q_s);
  e.solver.beginStep();
  e.world.performDiscreteCollisionDetection();
  Diagnostics found = e.overlaps();
  if (!found.empty()) return found;
  return Done{};
}

Fault BulletWorld::observe(const WorldQuery& query, WorldState& state) noexcept {
  bullet::BulletEngine& e = *engine_;
  e.hand.readJoints(state.theta, state.theta_dot);
  e.synergy.reduce(state.theta, state.q_s);
  state.qd_s = AxisVelocity(e.hand_model.axis_count);
  e.synergy.reduceRate(state.theta_dot.data(), state.qd_s.data());
  state.coupling_error_rad = e.coupling_error_rad;
  state.body_count = static_cast<int>(e.bodies.size());
  bool finite = allFinite(state.q_s) && allFinite(state.qd_s);
  for (int i = 0; i < state.body_count; ++i) {
    state.bodies[i] = e.bodies[i].state();
    finite = finite && allFinite(state.bodies[i]);
  }
  const PalmDistance::Result palm = e.palm_distance(e.kinematics.linkPose(e.hand_model.palm_link),
                                                    state.bodies.data(), query.targets);
  state.palm_distance_m = palm.any_m;
  state.palm_body = palm.target;
  state.palm_target_distance_m = palm.target_m;
  e.axis_closure.update(&e.kinematics.linkPose(0), state.theta, state.q_s, query.closure_body,
                        state.bodies.data(), state.closure);
  return finite ? Fault::kNone : Fault::kNonFiniteState;
}

void BulletWorld::placeBodies(const BodyPlacements& placements) noexcept {
  for (int i = 0; i < placements.count; ++i) {
    const BodyPlacement& placement = placements.items[i];
    if (placement.body < 0 || placement.body >= static_cast<int>(engine_->bodies.size())) continue;
    if (engine_->bodies[placement.body].place(placement)) {
      engine_->forgetContacts(placement.body);
    }
  }
}

Fault BulletWorld::step(const HandDrive& drive, double period_s) noexcept {
  bullet::BulletEngine& e = *engine_;
  if (drive.reduced_inertia_inverse == nullptr) return Fault::kPhysicsStep;
  e.period_s = period_s;
  e.solver.setReducedInertiaInverse(drive.reduced_inertia_inverse);
  e.solver.beginStep();
  e.rows.beginStep(e.kinematics, e.q_s);
  for (bullet::BulletBody& body : e.bodies) body.beginStep();
  e.hand.addTorque(drive.torque);
  e.world.stepSimulation(period_s, 0);

  JointPosition theta;
  JointVelocity theta_dot;
  e.hand.readJoints(theta, theta_dot);
  AxisPosition q_s;
  AxisVelocity qd_s(e.hand_model.axis_count);
  e.synergy.reduce(theta, q_s);
  e.synergy.reduceRate(theta_dot.data(), qd_s.data());
  if (!allFinite(q_s) || !allFinite(qd_s)) return Fault::kNonFiniteState;

  // The coupling holds but for rounding and the tiny masses of the base links; integrated over
  // minutes those would add up. The correction carries no load, and its size is recorded so that it
  // can hide nothing.
  JointPosition on_synergy;
  e.synergy.expand(q_s, on_synergy);
  e.coupling_error_rad = (theta.vec() - on_synergy.vec()).cwiseAbs().maxCoeff();
  e.synergy.expandRate(qd_s.data(), theta_dot.data());
  e.q_s = q_s;
  e.setHand(on_synergy, theta_dot.data());
  for (bullet::BulletBody& body : e.bodies) body.placeColliders();
  return Fault::kNone;
}

void BulletWorld::contacts(ContactList& contacts) const noexcept {
  const bullet::BulletEngine& e = *engine_;
  contacts.count = 0;
  contacts.dropped = e.solver.dropped();  // not even solved
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
    const SelfPair& pair = e.hand_model.self_contacts[static_cast<std::size_t>(touch.pair)];
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
