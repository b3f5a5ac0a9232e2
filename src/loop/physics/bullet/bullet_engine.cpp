#include "loop/physics/bullet/bullet_engine.hpp"

#include "loop/physics/bullet/bullet_shapes.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/free_motion.hpp"
#include "loop/physics/bullet/manifold_overlaps.hpp"

#include <algorithm>
#include <memory>

namespace wholehand::bullet {
namespace {

// Largest number of touching pairs for which memory is reserved; only scenes far too large for the
// tick have more.
constexpr std::size_t kRehearsedManifolds = 4096;

std::vector<BulletBody> makeBodies(const SceneModel& scene) {
  std::vector<BulletBody> bodies;
  bodies.reserve(scene.bodies.size() + scene.game.slots);
  for (const SceneBody& body : scene.bodies) {
    BulletBody& added =
        bodies.emplace_back(body, static_cast<int>(bodies.size()), contactThreshold());
    added.rigid().setGravity(toBt(scene.gravity_m_s2));
  }
  for (int slot = 0; slot < scene.game.slots; ++slot) {
    bodies.emplace_back(static_cast<int>(bodies.size()), scene.game.pieces, contactThreshold());
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
      solver(hand_in, kinematics, rows, settings,
             static_cast<int>(scene.bodies.size()) + scene.game.slots),
      hand(hand_in, scene.hand_friction),
      bodies(makeBodies(scene)),
      on_joints(scene.recordedJoints()),
      resting(bodies, scene.gravity_m_s2.norm(), settings.lets_rest),
      chains(scene, bodies),
      pairs(dispatcher, hand, bodies, resting, contactThreshold()),
      game(scene, bodies, resting, pairs, solver, dispatcher),
      q_s(hand_in.axis_count),
      qd_s(hand_in.axis_count),
      theta_dot(hand_in.joint_count) {
  configure(settings);
  for (const SceneBody& body : scene.bodies) body_names.push_back(body.name);
  bool any_joint = false;
  for (BulletBody& body : bodies) {
    if (body.joint() == nullptr) continue;
    solver.addJoint(body.rigid(), *body.joint());
    any_joint = true;
  }
  chains.addTo(solver);
  if (any_joint || chains.any()) touched_.resize(bodies.size());
  for (int i = 0; i < game.count(); ++i) body_names.push_back("slot " + std::to_string(i));
  for (int i = 0; i < game.firstBody(); ++i) {
    if (!bodies[i].moves()) fixed_.push_back(i);
  }
  states_.resize(std::min<std::size_t>(bodies.size(), kMaxBodies));
  moving_.reserve(bodies.size());
  moving_objects_.reserve(bodies.size());
  setHand(q_s, qd_s);
  rehearseManifolds();
  rehearseStep();
  if (settings.lets_rest) putStableBodiesToSleep();
}

// ADR 3 explains each setting that differs from Bullet's defaults.
void BulletEngine::configure(const SolverSettings& settings) {
  dispatcher.setDispatcherFlags(dispatcher.getDispatcherFlags() &
                                ~btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD);
  solver_info_.m_leastSquaresResidualThreshold = 0.0;
}

// Bullet's list of manifolds grows when needed. Makes more manifolds than any scene that fits into
// a tick, so that the list grows here and not while a person is attached.
void BulletEngine::rehearseManifolds() {
  const btCollisionObject none;
  manifolds_.reserve(kRehearsedManifolds);
  std::vector<btPersistentManifold*> manifolds;
  while (manifolds.size() < kRehearsedManifolds) {
    manifolds.push_back(dispatcher.getNewManifold(&none, &none));
  }
  for (btPersistentManifold* manifold : manifolds) dispatcher.releaseManifold(manifold);
}

// Makes one step of a microsecond, then restores the initial state.
void BulletEngine::rehearseStep() {
  AxisMatrix no_motion = AxisMatrix::Zero(hand_model.axis_count, hand_model.axis_count);
  solver.beginStep(no_motion, qd_s);
  advance(1e-6);
  solver.forgetStep();
  for (int i = 0; i < game.firstBody(); ++i) bodies[i].putAtStart();
  forgetContacts();
}

// Bodies that are stable in their initial pose rest from the start. The engine simulates 20 ms
// without the hand; bodies that have not moved are reset to their initial pose and rest.
void BulletEngine::putStableBodiesToSleep() {
  constexpr int kSteps = 20;
  constexpr double kStep_s = 1e-3;
  // Each contact yields by 10 µm, and a stack by the sum of its contacts.
  constexpr double kStood_m = 2e-4;
  // Speed below which a body has not moved: it accelerates by less than 0.25 mm/s².
  constexpr double kStood_m_s = 5e-6;
  std::vector<btVector3> start(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    start[i] = bodies[i].rigid().getWorldTransform().getOrigin();
  }
  for (int k = 0; k < kSteps; ++k) {
    solver.beginStep(AxisMatrix::Zero(hand_model.axis_count, hand_model.axis_count), qd_s);
    pairs.findOfBodies(kStep_s);
    moveBodies(kStep_s);
  }
  std::vector<bool> fell(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const btRigidBody& rigid = bodies[i].rigid();
    fell[i] = (rigid.getWorldTransform().getOrigin() - start[i]).length() > kStood_m ||
              rigid.getLinearVelocity().length() > kStood_m_s;
  }
  resting.restAtOnce(pairs.near(), fell);
  solver.forgetStep();
  for (int i = 0; i < static_cast<int>(bodies.size()); ++i) {
    if (i < game.firstBody()) bodies[i].putAtStart();
    pairs.moved(i);
    updateState(i);
  }
  forgetContacts();
}

// Rebuilds the lists only after a change of pairs or of resting bodies.
void BulletEngine::listMoving() noexcept {
  if (listed_ && pairs_listed_ == pairs.version() && resting_listed_ == resting.version() &&
      game_listed_ == game.version()) {
    return;
  }
  listed_ = true;
  pairs_listed_ = pairs.version();
  resting_listed_ = resting.version();
  game_listed_ = game.version();
  // Awake bodies that are not ghosts.
  moving_.clear();
  moving_objects_.clear();
  for (const int body : resting.awakeBodies()) {
    if (game.isGhost(body)) continue;
    moving_.push_back(&bodies[body]);
    if (!bodies[body].isLed()) moving_objects_.push_back(&bodies[body].rigid());
  }
  // Contacts of the hand or of an awake body, without ghosts.
  manifolds_.clear();
  unsolved_ = 0;
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(m);
    const ColliderTag* a = tagOf(manifold->getBody0());
    const ColliderTag* b = tagOf(manifold->getBody1());
    const bool stands =
        !a->ofHand() && !b->ofHand() && !resting.awake(a->body) && !resting.awake(b->body);
    if (stands || game.isGhost(a->body) || game.isGhost(b->body)) continue;
    if (manifolds_.size() < manifolds_.capacity()) {
      manifolds_.push_back(manifold);
    } else {
      ++unsolved_;
    }
  }
}

void BulletEngine::beginStep() noexcept {
  for (const int body : fixed_) {
    bodies[body].beginStep();
    updateState(body);
  }
}

const std::vector<BodyState>& BulletEngine::bodyStates() noexcept {
  for (const int body : resting.awakeBodies()) updateState(body);
  if (game_shown_ != game.version()) {
    game_shown_ = game.version();
    for (int i = 0; i < game.count(); ++i) updateState(game.firstBody() + i);
  }
  return states_;
}

void BulletEngine::updateState(int body) noexcept {
  if (body < static_cast<int>(states_.size())) states_[body] = bodies[body].state();
}

void BulletEngine::advance(double step_s) noexcept {
  pairs.find(step_s);
  game.settle(step_s);
  game.drive(step_s);
  moveBodies(step_s);
  game.finish(step_s);
  if (!resting.watch(step_s)) return;
  resting.layDown(pairs.near());
  for (int i = 0; i < static_cast<int>(states_.size()); ++i) updateState(i);
}

void BulletEngine::findTouchedJoints() noexcept {
  if (touched_.empty()) return;
  std::fill(touched_.begin(), touched_.end(), 0);
  for (const btPersistentManifold* manifold : manifolds_) {
    if (manifold->getNumContacts() == 0) continue;
    for (const btCollisionObject* object : {manifold->getBody0(), manifold->getBody1()}) {
      const ColliderTag* tag = tagOf(object);
      if (!tag->ofHand()) touched_[tag->body] = 1;
    }
  }
}

void BulletEngine::moveBodies(double step_s) noexcept {
  listMoving();
  findTouchedJoints();
  for (BulletBody* body : moving_) {
    btRigidBody& rigid = body->rigid();
    if (BodyJoint* joint = body->joint()) {
      joint->predict(toEigen(rigid.getGravity()), step_s, touched_[body - bodies.data()] != 0);
      body->moveWithJoint();
      continue;
    }
    if (body->chain() != nullptr) continue;
    rigid.applyGravity();
    if (rigid.getLinearDamping() != 0.0) rigid.applyDamping(step_s);
  }
  chains.predict(resting, touched_, step_s);
  solver_info_.m_timeStep = step_s;
  solver_info_.m_numIterations =
      std::max({sweepsOfHand(solver.settings(), step_s), kUnevenSweeps, kMostFarSweeps});
  // Solves the whole world in one call, because the hand's reduced velocities are one set of
  // unknowns.
  solver.solveGroup(moving_objects_.data(), static_cast<int>(moving_objects_.size()),
                    manifolds_.data(), static_cast<int>(manifolds_.size()), nullptr, 0,
                    solver_info_, nullptr, &dispatcher);
  for (BulletBody* body : moving_) {
    if (body->joint() != nullptr) {
      body->finishJoint(step_s);
      continue;
    }
    if (body->chain() != nullptr) continue;
    moveFree(body->rigid(), step_s);
    body->rigid().clearForces();
  }
  chains.finish(resting, step_s);
  for (const int body : resting.awakeBodies()) bodies[body].placeColliders(step_s);
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
  pairs.find(0.0);
  HandOverlaps found(bodies.size());
  addOverlaps(dispatcher, found);
  return found.refuse(hand_model, scene_path, body_names);
}

}  // namespace wholehand::bullet
