#include "physics/bullet/bullet_engine.hpp"

#include "physics/bullet/bullet_types.hpp"

#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <algorithm>
#include <cstdio>
#include <memory>

namespace wholehand::bullet {
namespace {

// Collision groups: the hand meets bodies, never itself.
constexpr int kBodyGroup = 1;
constexpr int kPalmGroup = 2;
constexpr int kRehearsalGroup = 4;
constexpr int kDigitGroup = 8;
constexpr int kNoGroup = 0;

int maskOf(BulletBody::Meets meets) {
  switch (meets) {
    case BulletBody::Meets::kAll:
      return kBodyGroup | kPalmGroup | kDigitGroup;
    case BulletBody::Meets::kAllButDigits:
      return kBodyGroup | kPalmGroup;
    case BulletBody::Meets::kDigits:
      return kDigitGroup;
  }
  return kNoGroup;
}

// More than this many pairs touch at once only in scenes far too large for the tick.
constexpr std::size_t kRehearsedManifolds = 1024;

// Surfaces nearer than this are a contact point; boxes are padded by as much. Bullet keeps it in
// one variable of the process, so it is one constant, set once.
double contactThreshold() {
  static const double kThreshold_m = gContactBreakingThreshold = 5e-4;
  return kThreshold_m;
}

// Deeper than this at the start, the solver would throw the body away.
constexpr double kAllowedOverlap_m = 2e-4;

}  // namespace

BulletEngine::BulletEngine(const HandModel& hand_in, const SceneModel& scene,
                           const SolverSettings& settings)
    : hand_model(hand_in),
      synergy(hand_in),
      kinematics(hand_in),
      scene_path(scene.path),
      dispatcher(&configuration, contactThreshold()),
      rows(hand_in, scene.hand_friction, settings),
      solver(hand_in, kinematics, rows, settings),
      world(&dispatcher, &broadphase, &solver, &configuration),
      hand(hand_in, scene.hand_friction),
      q_s(hand_in.axis_count),
      qd_s(hand_in.axis_count),
      theta_dot(hand_in.joint_count) {
  configure(scene, settings);
  for (std::size_t i = 0; i < hand.capsules().size(); ++i) {
    const bool palm = hand_in.capsules[i].part == HandPart::kPalm;
    world.addCollisionObject(hand.capsules()[i].get(), palm ? kPalmGroup : kDigitGroup, kBodyGroup);
  }
  bodies.reserve(scene.bodies.size());
  for (const SceneBody& body : scene.bodies) {
    BulletBody& added = bodies.emplace_back(body, static_cast<int>(bodies.size()));
    body_names.push_back(body.name);
    world.addRigidBody(&added.rigid(), kNoGroup, kNoGroup);
    for (const auto& collider : added.colliders()) {
      world.addCollisionObject(collider->object.get(), kBodyGroup, maskOf(collider->meets));
    }
  }
  rehearsePairs();
  rehearseManifolds();
  rehearseStep();
}

BulletEngine::~BulletEngine() {
  for (auto& body : bodies) {
    for (const auto& collider : body.colliders())
      world.removeCollisionObject(collider->object.get());
    world.removeRigidBody(&body.rigid());
  }
  for (const auto& capsule : hand.capsules()) world.removeCollisionObject(capsule.get());
}

// Each setting that differs from stock is explained in ADR 3.
void BulletEngine::configure(const SceneModel& scene, const SolverSettings& settings) {
  world.setGravity(toBt(scene.gravity_m_s2));
  dispatcher.setDispatcherFlags(dispatcher.getDispatcherFlags() &
                                ~btCollisionDispatcher::CD_USE_RELATIVE_CONTACT_BREAKING_THRESHOLD);
  world.setForceUpdateAllAabbs(true);
  // One solver call for the whole world: the hand's reduced velocities are one set of unknowns.
  world.getSimulationIslandManager()->setSplitIslands(false);
  btContactSolverInfo& info = world.getSolverInfo();
  info.m_numIterations = settings.iterations;
  info.m_leastSquaresResidualThreshold = 0.0;
  info.m_splitImpulse = 0;
  info.m_erp2 = settings.contact_erp;
  info.m_frictionERP = settings.friction_anchor_erp;
  info.m_linearSlop = settings.penetration_slop_m;
  info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS;
}

// Bullet's arrays grow when they first need to. Every capsule near every body at once is the worst
// that can happen, so it happens here, before anybody is attached.
void BulletEngine::rehearsePairs() {
  btSphereShape shape(0.01);
  const std::size_t count = std::min<std::size_t>(64, colliders().size());
  std::vector<std::unique_ptr<btCollisionObject>> crowd;
  for (std::size_t i = 0; i < count; ++i) {
    crowd.push_back(std::make_unique<btCollisionObject>());
    crowd.back()->setCollisionShape(&shape);
    crowd.back()->setWorldTransform(toBt(Pose{Eigen::Matrix3d::Identity(), {0, 0, 1e3}}));
    world.addCollisionObject(crowd.back().get(), kRehearsalGroup, kRehearsalGroup);
  }
  world.updateAabbs();
  broadphase.calculateOverlappingPairs(&dispatcher);
  for (auto& object : crowd) world.removeCollisionObject(object.get());
}

void BulletEngine::rehearseManifolds() {
  const std::vector<btCollisionObject*> all = colliders();
  std::vector<btPersistentManifold*> manifolds;
  for (std::size_t a = 0; a < all.size() && manifolds.size() < kRehearsedManifolds; ++a) {
    for (std::size_t b = a + 1; b < all.size() && manifolds.size() < kRehearsedManifolds; ++b) {
      manifolds.push_back(dispatcher.getNewManifold(all[a], all[b]));
    }
  }
  for (btPersistentManifold* manifold : manifolds) dispatcher.releaseManifold(manifold);
}

std::vector<btCollisionObject*> BulletEngine::colliders() const {
  std::vector<btCollisionObject*> all;
  for (const auto& capsule : hand.capsules()) all.push_back(capsule.get());
  for (const auto& body : bodies) {
    for (const auto& collider : body.colliders()) all.push_back(collider->object.get());
  }
  return all;
}

// One step of a microsecond, then everything is put back as it was.
void BulletEngine::rehearseStep() {
  AxisMatrix no_motion = AxisMatrix::Zero(hand_model.axis_count, hand_model.axis_count);
  solver.beginStep(no_motion, qd_s);
  world.stepSimulation(1e-6, 0);
  solver.forgetStep();
  for (BulletBody& body : bodies) body.putAtStart();
  forgetContacts();
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
  struct Deepest {
    double depth_m = kAllowedOverlap_m;
    int capsule = -1;
  };
  std::vector<Deepest> deepest(bodies.size());
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    const ColliderTag* a = tagOf(manifold.getBody0());
    const ColliderTag* b = tagOf(manifold.getBody1());
    if (a->ofHand() == b->ofHand()) continue;
    const int capsule = (a->ofHand() ? a : b)->capsule;
    Deepest& found = deepest[(a->ofHand() ? b : a)->body];
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      const double depth_m = -manifold.getContactPoint(k).getDistance();
      if (depth_m > found.depth_m) found = {depth_m, capsule};
    }
  }
  Diagnostics errors;
  for (std::size_t i = 0; i < deepest.size(); ++i) {
    if (deepest[i].capsule < 0) continue;
    Diagnostic d{scene_path, 0, "bodies." + body_names[i], "", "", ""};
    char problem[160];
    std::snprintf(problem, sizeof problem, "starts %.1f mm inside the hand (its %s)",
                  deepest[i].depth_m * 1e3, hand_model.capsules[deepest[i].capsule].name.c_str());
    d.problem = problem;
    d.remedy = "move the body, or let the motion start elsewhere";
    errors.push_back(std::move(d));
  }
  return errors;
}

}  // namespace wholehand::bullet
