#include "physics/bullet/bullet_world.hpp"

#include "dynamics/synergy.hpp"
#include "physics/bullet/bullet_bodies.hpp"
#include "physics/bullet/bullet_hand.hpp"
#include "physics/bullet/bullet_types.hpp"
#include "physics/bullet/near_filter.hpp"
#include "physics/bullet/reduced_contact_solver.hpp"
#include "physics/palm_distance.hpp"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace wholehand {
namespace {

using bullet::toBt;
using bullet::toVec3;

// Collision groups: the hand meets bodies, never itself.
constexpr int kBodyGroup = 1;
constexpr int kHandGroup = 2;
constexpr int kRehearsalGroup = 4;
constexpr int kNoGroup = 0;

// More than this many pairs touch at once only in scenes far too large for the tick.
constexpr std::size_t kRehearsedManifolds = 1024;

// Deeper than this at the start, the solver would throw the body away.
constexpr double kAllowedOverlap_m = 2e-4;

}  // namespace

struct BulletWorld::Engine {
  Engine(const HandModel& hand, const SceneModel& scene, const BulletSettings& settings);
  ~Engine();

  void configure(const SceneModel& scene, const BulletSettings& settings);
  void rehearse();
  void rehearsePairs();
  void rehearseManifolds();
  void rehearseStep();
  std::vector<btCollisionObject*> colliders() const;
  void setHand(const JointPosition& theta, const double* theta_dot) noexcept;
  Diagnostics overlaps();

  const HandModel& hand_model;
  Synergy synergy;
  ArticulatedBody kinematics;
  PalmDistance palm_distance;
  std::string scene_path;
  std::vector<std::string> body_names;
  btDefaultCollisionConfiguration configuration;
  bullet::NearFilter dispatcher;
  btDbvtBroadphase broadphase;
  bullet::ReducedContactSolver solver;
  btMultiBodyDynamicsWorld world;
  bullet::BulletHand hand;
  std::vector<bullet::BulletBody> bodies;
  double coupling_error_rad = 0.0;
  double period_s = 1e-3;
};

BulletWorld::Engine::Engine(const HandModel& hand_in, const SceneModel& scene,
                            const BulletSettings& settings)
    : hand_model(hand_in),
      synergy(hand_in),
      kinematics(hand_in),
      palm_distance(hand_in, scene),
      scene_path(scene.path),
      dispatcher(&configuration, settings.contact_threshold_m),
      solver(hand_in, synergy, settings),
      world(&dispatcher, &broadphase, &solver, &configuration),
      hand(hand_in, scene.hand_friction) {
  configure(scene, settings);
  solver.attach(&hand.body(), &kinematics);
  world.addMultiBody(&hand.body());
  for (const auto& capsule : hand.capsules()) {
    world.addCollisionObject(capsule.get(), kHandGroup, kBodyGroup);
  }
  bodies.reserve(scene.bodies.size());
  for (const SceneBody& body : scene.bodies) {
    bullet::BulletBody& added = bodies.emplace_back(body, static_cast<int>(bodies.size()));
    body_names.push_back(body.name);
    world.addRigidBody(&added.rigid(), kNoGroup, kNoGroup);
    for (const auto& collider : added.colliders()) {
      world.addCollisionObject(collider->object.get(), kBodyGroup, kBodyGroup | kHandGroup);
    }
  }
  rehearse();
}

BulletWorld::Engine::~Engine() {
  for (auto& body : bodies) {
    for (const auto& collider : body.colliders())
      world.removeCollisionObject(collider->object.get());
    world.removeRigidBody(&body.rigid());
  }
  for (const auto& capsule : hand.capsules()) world.removeCollisionObject(capsule.get());
  world.removeMultiBody(&hand.body());
}

// Each setting that differs from stock is explained in ADR 3.
void BulletWorld::Engine::configure(const SceneModel& scene, const BulletSettings& settings) {
  world.setGravity(toBt(scene.gravity_m_s2));
  gContactBreakingThreshold = settings.contact_threshold_m;
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

void BulletWorld::Engine::rehearse() {
  rehearsePairs();
  rehearseManifolds();
  rehearseStep();
}

// Bullet's arrays grow when they first need to. Every capsule near every body at once is the worst
// that can happen, so it happens here, before anybody is attached.
void BulletWorld::Engine::rehearsePairs() {
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

void BulletWorld::Engine::rehearseManifolds() {
  const std::vector<btCollisionObject*> all = colliders();
  std::vector<btPersistentManifold*> manifolds;
  for (std::size_t a = 0; a < all.size() && manifolds.size() < kRehearsedManifolds; ++a) {
    for (std::size_t b = a + 1; b < all.size() && manifolds.size() < kRehearsedManifolds; ++b) {
      manifolds.push_back(dispatcher.getNewManifold(all[a], all[b]));
    }
  }
  for (btPersistentManifold* manifold : manifolds) dispatcher.releaseManifold(manifold);
}

std::vector<btCollisionObject*> BulletWorld::Engine::colliders() const {
  std::vector<btCollisionObject*> all;
  for (const auto& capsule : hand.capsules()) all.push_back(capsule.get());
  for (const auto& body : bodies) {
    for (const auto& collider : body.colliders()) all.push_back(collider->object.get());
  }
  return all;
}

// One step of a microsecond, then everything is put back as it was.
void BulletWorld::Engine::rehearseStep() {
  AxisMatrix no_motion = AxisMatrix::Zero(hand_model.axis_count, hand_model.axis_count);
  solver.beginStep();
  solver.setReducedInertiaInverse(&no_motion);
  world.stepSimulation(1e-6, 0);
  solver.beginStep();
  for (bullet::BulletBody& body : bodies) body.putAtStart();
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    dispatcher.getManifoldByIndexInternal(m)->clearManifold();
  }
}

void BulletWorld::Engine::setHand(const JointPosition& theta, const double* theta_dot) noexcept {
  hand.writeJoints(theta, theta_dot);
  kinematics.updateKinematics(theta);
  hand.placeCapsules(kinematics);
}

// The deepest overlap of each body with the hand.
Diagnostics BulletWorld::Engine::overlaps() {
  struct Deepest {
    double depth_m = kAllowedOverlap_m;
    int capsule = -1;
  };
  std::vector<Deepest> deepest(bodies.size());
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    const bullet::ColliderTag* a = bullet::tagOf(manifold.getBody0());
    const bullet::ColliderTag* b = bullet::tagOf(manifold.getBody1());
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

BulletWorld::BulletWorld(const HandModel& hand, const SceneModel& scene,
                         const BulletSettings& settings)
    : engine_(std::make_unique<Engine>(hand, scene, settings)) {}

BulletWorld::~BulletWorld() = default;

Expected<Done> BulletWorld::placeHand(const AxisPosition& q_s) {
  Engine& e = *engine_;
  JointPosition theta;
  e.synergy.expand(q_s, theta);
  const std::array<double, kMaxJoints> at_rest{};
  e.setHand(theta, at_rest.data());
  e.coupling_error_rad = 0.0;
  e.solver.beginStep();
  e.world.performDiscreteCollisionDetection();
  Diagnostics found = e.overlaps();
  if (!found.empty()) return found;
  return Done{};
}

Fault BulletWorld::observe(WorldState& state) noexcept {
  Engine& e = *engine_;
  e.hand.readJoints(state.theta, state.theta_dot);
  e.synergy.reduce(state.theta, state.q_s);
  state.qd_s = AxisVelocity(e.hand_model.axis_count);
  e.synergy.reduceRate(state.theta_dot.data(), state.qd_s.data());
  state.coupling_error_rad = e.coupling_error_rad;
  state.body_count = static_cast<int>(e.bodies.size());
  bool finite = allFinite(state.q_s) && allFinite(state.qd_s);
  for (int i = 0; i < state.body_count; ++i) {
    state.bodies[i] = e.bodies[i].state();
    finite = finite && state.bodies[i].position_m.eigen().allFinite() &&
             state.bodies[i].velocity_m_s.eigen().allFinite();
  }
  state.palm_distance_m =
      e.palm_distance(e.kinematics.linkPose(e.hand_model.palm_link), state.bodies.data());
  return finite ? Fault::kNone : Fault::kNonFiniteState;
}

Fault BulletWorld::step(const HandDrive& drive, double period_s) noexcept {
  Engine& e = *engine_;
  e.period_s = period_s;
  e.solver.setReducedInertiaInverse(drive.reduced_inertia_inverse);
  e.solver.beginStep();
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

  // The coupling holds but for rounding and placeholder masses; integrated over minutes those would
  // add up. The correction carries no load, and its size is recorded so that it can hide nothing.
  JointPosition on_synergy;
  e.synergy.expand(q_s, on_synergy);
  e.coupling_error_rad = (theta.vec() - on_synergy.vec()).cwiseAbs().maxCoeff();
  e.synergy.expandRate(qd_s.data(), theta_dot.data());
  e.setHand(on_synergy, theta_dot.data());
  for (bullet::BulletBody& body : e.bodies) body.placeColliders();
  return Fault::kNone;
}

void BulletWorld::contacts(ContactList& contacts) const noexcept {
  const Engine& e = *engine_;
  contacts.count = 0;
  contacts.dropped = e.solver.dropped();
  for (int i = 0; i < e.solver.contactCount(); ++i) {
    const bullet::HandContact& c = e.solver.contact(i);
    if (c.normal_row.impulse <= 0.0) continue;
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

}  // namespace wholehand
