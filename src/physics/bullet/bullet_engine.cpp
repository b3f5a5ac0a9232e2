#include "physics/bullet/bullet_engine.hpp"

#include "physics/bullet/bullet_shapes.hpp"
#include "physics/bullet/bullet_types.hpp"
#include "physics/hand_overlaps.hpp"

#include <algorithm>
#include <memory>

namespace wholehand::bullet {
namespace {

// More than this many pairs touch at once only in scenes far too large for the tick.
constexpr std::size_t kRehearsedManifolds = 1024;

std::vector<BulletBody> makeBodies(const SceneModel& scene) {
  std::vector<BulletBody> bodies;
  bodies.reserve(scene.bodies.size());
  for (const SceneBody& body : scene.bodies) {
    BulletBody& added =
        bodies.emplace_back(body, static_cast<int>(bodies.size()), contactThreshold());
    added.rigid().setGravity(toBt(scene.gravity_m_s2));
  }
  return bodies;
}

}  // namespace

BulletEngine::BulletEngine(const HandModel& hand_in, const SceneModel& scene,
                           const SolverSettings& settings)
    : hand_model(hand_in),
      synergy(hand_in),
      kinematics(hand_in),
      scene_path(scene.path),
      dispatcher(&configuration),
      rows(hand_in, scene.hand_friction, settings),
      solver(hand_in, kinematics, rows, settings),
      hand(hand_in, scene.hand_friction),
      bodies(makeBodies(scene)),
      pairs(dispatcher, hand, bodies, contactThreshold()),
      q_s(hand_in.axis_count),
      qd_s(hand_in.axis_count),
      theta_dot(hand_in.joint_count) {
  configure(settings);
  for (const SceneBody& body : scene.bodies) body_names.push_back(body.name);
  for (BulletBody& body : bodies) {
    if (!body.moves()) continue;
    moving_.push_back(&body.rigid());
    moving_objects_.push_back(&body.rigid());
  }
  setHand(q_s, qd_s);
  rehearseManifolds();
  rehearseStep();
}

// Each setting that differs from stock is explained in ADR 3.
void BulletEngine::configure(const SolverSettings& settings) {
  dispatcher.setDispatcherFlags(dispatcher.getDispatcherFlags() &
                                ~btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD);
  solver_info_.m_numIterations = settings.iterations;
  solver_info_.m_leastSquaresResidualThreshold = 0.0;
  solver_info_.m_splitImpulse = 0;
  solver_info_.m_erp2 = settings.contact_erp;
  solver_info_.m_frictionERP = settings.friction_anchor_erp;
  solver_info_.m_linearSlop = settings.penetration_slop_m;
  solver_info_.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
}

// The list of manifolds grows when it first needs to. More at once than in any scene that a tick
// has time for happen here, before anybody is attached.
void BulletEngine::rehearseManifolds() {
  const btCollisionObject none;
  std::vector<btPersistentManifold*> manifolds;
  while (manifolds.size() < kRehearsedManifolds) {
    manifolds.push_back(dispatcher.getNewManifold(&none, &none));
  }
  for (btPersistentManifold* manifold : manifolds) dispatcher.releaseManifold(manifold);
}

// One step of a microsecond, then everything is put back as it was.
void BulletEngine::rehearseStep() {
  AxisMatrix no_motion = AxisMatrix::Zero(hand_model.axis_count, hand_model.axis_count);
  solver.beginStep(no_motion, qd_s);
  advance(1e-6);
  solver.forgetStep();
  for (BulletBody& body : bodies) body.putAtStart();
  forgetContacts();
}

void BulletEngine::advance(double step_s) noexcept {
  for (btRigidBody* body : moving_) {
    body->applyGravity();
    body->applyDamping(step_s);
  }
  pairs.find();
  solver_info_.m_timeStep = step_s;
  // One call for the whole world: the hand's reduced velocities are one set of unknowns.
  solver.solveGroup(moving_objects_.data(), static_cast<int>(moving_objects_.size()),
                    dispatcher.getInternalManifoldPointer(), dispatcher.getNumManifolds(), nullptr,
                    0, solver_info_, nullptr, &dispatcher);
  for (btRigidBody* body : moving_) {
    btTransform moved;
    body->predictIntegratedTransform(step_s, moved);
    body->proceedToTransform(moved);
    body->clearForces();
  }
}

void BulletEngine::forgetContacts(int body) noexcept {
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    const bool its = body < 0 || tagOf(manifold.getBody0())->body == body ||
                     tagOf(manifold.getBody1())->body == body;
    if (its) manifold.clearManifold();
  }
}

void BulletEngine::setHand(const AxisPosition& position, const AxisVelocity& velocity) noexcept {
  q_s = position;
  qd_s = velocity;
  synergy.expand(q_s, theta);
  synergy.expandRate(qd_s.data(), theta_dot.data());
  kinematics.updateKinematics(theta);
  hand.placeCapsules(kinematics);
}

// The deepest overlap of each body with the hand.
Diagnostics BulletEngine::overlaps() {
  pairs.find();
  HandOverlaps found(bodies.size());
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    const ColliderTag* a = tagOf(manifold.getBody0());
    const ColliderTag* b = tagOf(manifold.getBody1());
    if (a->ofHand() == b->ofHand()) continue;
    const int capsule = (a->ofHand() ? a : b)->capsule;
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      found.add((a->ofHand() ? b : a)->body, capsule, -manifold.getContactPoint(k).getDistance());
    }
  }
  return found.refuse(hand_model, scene_path, body_names);
}

}  // namespace wholehand::bullet
