#include "lab/bullet_paper/bullet_paper_world.hpp"

#include "lab/bullet_paper/paper_engine.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/bullet_world.hpp"
#include "loop/physics/physics_world.hpp"

#include <algorithm>
#include <utility>

namespace wholehand {
namespace {

using bullet::ColliderTag;
using bullet::tagOf;
using bullet::toVec3;

Diagnostics refuseSoftThatMoves(const SceneModel& scene) {
  Diagnostics errors;
  for (const SceneBody& body : scene.bodies) {
    if (body.fixed || body.soft_m == 0.0) continue;
    errors.push_back({scene.path, 0, "bodies." + body.name + ".soft_m", "",
                      "is of a body that moves, and the engine bullet-paper has soft bodies fixed "
                      "only",
                      "use --engine bullet, or fix the body"});
  }
  return errors;
}

/// @param sign 1 if the hand is the first of Bullet's two bodies, else -1
Contact contactOf(const btManifoldPoint& point, const ColliderTag& of_hand, int body, double sign,
                  double period_s) {
  const btVector3 impulse = point.m_normalWorldOnB * point.m_appliedImpulse +
                            point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
                            point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2;
  Contact out;
  out.capsule = of_hand.capsule;
  out.link = of_hand.link;
  out.body = body;
  out.point_m = toVec3(sign > 0.0 ? point.getPositionWorldOnA() : point.getPositionWorldOnB());
  out.normal = toVec3(point.m_normalWorldOnB * sign);
  out.force_n = toVec3(impulse * (sign / period_s));
  out.distance_m = point.getDistance();
  return out;
}

}  // namespace

Expected<std::unique_ptr<PhysicsWorld>> BulletPaperWorld::build(const HandModel& hand,
                                                                const SceneModel& scene) {
  return buildWith(hand, scene, bullet_paper::PaperCoupling::kResets);
}

Expected<std::unique_ptr<PhysicsWorld>> BulletPaperWorld::buildGeared(const HandModel& hand,
                                                                      const SceneModel& scene) {
  return buildWith(hand, scene, bullet_paper::PaperCoupling::kGears);
}

Expected<std::unique_ptr<PhysicsWorld>> BulletPaperWorld::buildWith(
    const HandModel& hand, const SceneModel& scene, bullet_paper::PaperCoupling coupling) {
  Diagnostics refused = bullet_paper::PaperHand::refuse(hand, coupling);
  for (Diagnostic& soft : refuseSoftThatMoves(scene)) refused.push_back(std::move(soft));
  if (!refused.empty()) return refused;
  bullet::useCheckedMemory();
  return std::unique_ptr<PhysicsWorld>(
      new BulletPaperWorld(std::make_unique<bullet_paper::PaperEngine>(hand, scene, coupling)));
}

BulletPaperWorld::BulletPaperWorld(std::unique_ptr<bullet_paper::PaperEngine> engine)
    : engine_(std::move(engine)) {}

BulletPaperWorld::~BulletPaperWorld() = default;

Expected<Done> BulletPaperWorld::placeHand(const AxisPosition& q_s) {
  bullet_paper::PaperEngine& e = *engine_;
  for (std::size_t i = 0; i < e.bodies.size(); ++i) {
    if (!allFinite(e.bodies[i].state())) return nonFiniteBodyError(e.scene_path, e.body_names[i]);
  }
  e.forgetContacts();
  e.setHand(q_s, AxisVelocity(e.hand_model.axis_count));
  e.coupling_error_rad = 0.0;
  Diagnostics found = e.overlaps();
  if (!found.empty()) return found;
  return Done{};
}

Fault BulletPaperWorld::observe(PhysicsState& state) noexcept {
  bullet_paper::PaperEngine& e = *engine_;
  state.q_s = e.q_s;
  state.qd_s = e.qd_s;
  e.hand.readJoints(state.theta, state.theta_dot);
  state.coupling_error_rad = e.coupling_error_rad;
  state.body_count = std::min(static_cast<int>(e.bodies.size()), kMaxBodies);
  bool finite = allFinite(state.q_s) && allFinite(state.qd_s);
  for (int i = 0; i < state.body_count; ++i) {
    BodyState& body = state.bodies[i];
    body = e.bodies[i].state();
    finite = finite && allFinite(body);
  }
  return finite ? Fault::kNone : Fault::kNonFiniteState;
}

void BulletPaperWorld::placeBodies(const BodyPlacements& placements) noexcept {
  for (int i = 0; i < placements.count; ++i) {
    const BodyPlacement& placement = placements.items[i];
    if (placement.body < 0 || placement.body >= static_cast<int>(engine_->bodies.size())) continue;
    if (engine_->bodies[placement.body].place(placement)) {
      engine_->forgetContacts(placement.body);
    }
  }
}

Fault BulletPaperWorld::step(const HandDrive& drive, double period_s) noexcept {
  bullet_paper::PaperEngine& e = *engine_;
  if (drive.torque.size() != e.hand_model.joint_count || !allFinite(drive.torque) ||
      drive.effort.size() != e.qd_s.size() || drive.reduced_inertia_inverse == nullptr) {
    return Fault::kPhysicsStep;
  }
  AxisVelocity untouched = e.qd_s;  // + T M_r⁻¹ f_s, the velocity that the motors follow
  for (int a = 0; a < untouched.size(); ++a) {
    for (int b = 0; b < untouched.size(); ++b) {
      untouched[a] += period_s * (*drive.reduced_inertia_inverse)(b, a) * drive.effort[b];
    }
  }
  e.period_s = period_s;
  for (bullet_paper::PaperBody& body : e.bodies) body.beginStep(period_s);
  e.hand.drive(drive.torque, untouched);
  e.world.stepSimulation(period_s, 0);  // exactly one step of period_s
  for (bullet_paper::PaperBody& body : e.bodies) body.endStep();
  AxisPosition q_s;
  AxisVelocity qd_s;
  e.coupling_error_rad = e.hand.take(q_s, qd_s);
  if (!allFinite(q_s) || !allFinite(qd_s)) return Fault::kNonFiniteState;
  e.q_s = q_s;
  e.qd_s = qd_s;
  e.hand.settle(q_s, qd_s);
  return Fault::kNone;
}

void BulletPaperWorld::contacts(ContactList& contacts) const noexcept {
  const bullet_paper::PaperEngine& e = *engine_;
  contacts.count = contacts.dropped = 0;
  for (int m = 0; m < e.dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *e.dispatcher.getManifoldByIndexInternal(m);
    const ColliderTag *a = tagOf(manifold.getBody0()), *b = tagOf(manifold.getBody1());
    if (a->ofHand() == b->ofHand()) continue;
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold.getContactPoint(k);
      if (point.m_appliedImpulse <= 0.0) continue;
      if (contacts.count == kMaxContacts) {
        ++contacts.dropped;
        continue;
      }
      contacts.points[contacts.count++] = a->ofHand()
                                              ? contactOf(point, *a, b->body, 1.0, e.period_s)
                                              : contactOf(point, *b, a->body, -1.0, e.period_s);
    }
  }
}

void BulletPaperWorld::selfForces(SelfForces& forces) const noexcept {
  forces.count = 0;
  forces.joint_ends = AxisEffort(engine_->hand_model.axis_count);
}

}  // namespace wholehand
