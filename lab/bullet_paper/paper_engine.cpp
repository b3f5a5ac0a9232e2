#include "lab/bullet_paper/paper_engine.hpp"

#include "lab/bullet_paper/collision_groups.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/physics/bullet/bullet_shapes.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/manifold_overlaps.hpp"

#include <algorithm>
#include <limits>

namespace wholehand::bullet_paper {
namespace {

constexpr double kStockContactThreshold = 0.02;  // share of the smaller shape's size
constexpr int kReservedContacts = 4 * kMaxContacts;
constexpr int kReservedManifolds = 1024;

}  // namespace

btPersistentManifold* PaperDispatcher::getNewManifold(const btCollisionObject* a,
                                                      const btCollisionObject* b) {
  btPersistentManifold* manifold = btCollisionDispatcher::getNewManifold(a, b);
  manifold->setContactBreakingThreshold(
      std::min(a->getCollisionShape()->getContactBreakingThreshold(kStockContactThreshold),
               b->getCollisionShape()->getContactBreakingThreshold(kStockContactThreshold)));
  return manifold;
}

PaperSolver::PaperSolver(int dofs) {
  m_multiBodyNormalContactConstraints.reserve(kReservedContacts);
  m_multiBodyFrictionContactConstraints.reserve(kReservedContacts);
  m_data.m_jacobians.reserve(2 * kReservedContacts * (6 + dofs));
  m_data.m_deltaVelocitiesUnitImpulse.reserve(2 * kReservedContacts * (6 + dofs));
}

PaperEngine::PaperEngine(const HandModel& hand_in, const SceneModel& scene, PaperCoupling coupling)
    : hand_model(hand_in),
      synergy(hand_in),
      scene_path(scene.path),
      hand(hand_in, scene.hand_friction, coupling),
      dispatcher(&configuration),
      solver(hand_in.joint_count),
      world(&dispatcher, &broadphase, &solver, &configuration),
      q_s(hand_in.axis_count),
      qd_s(hand_in.axis_count) {
  (void)bullet::contactThreshold();  // sets one value for the process, whichever engine is built
                                     // first
  for (const SceneBody& body : scene.bodies) {
    body_names.push_back(body.name);
    bodies.emplace_back(body, static_cast<int>(bodies.size()));
  }
  configure(scene);
  world.addMultiBody(&hand.body());
  for (btMultiBodyConstraint* one : hand.constraints()) world.addMultiBodyConstraint(one);
  for (int i = 0; i < static_cast<int>(hand.capsules().size()); ++i) {
    const int group = hand.isPalm(i) ? kPalm : kDigit;
    world.addCollisionObject(hand.capsules()[i].get(), group, meets(group));
  }
  for (const PaperBody& body : bodies) {
    for (const PaperBody::Part& part : body.parts()) {
      world.addRigidBody(part.rigid.get(), part.group, meets(part.group));
    }
  }
  setHand(q_s, qd_s);
  rehearse();
}

PaperEngine::~PaperEngine() {
  for (const PaperBody& body : bodies) {
    for (const PaperBody::Part& part : body.parts()) world.removeRigidBody(part.rigid.get());
  }
  for (const auto& capsule : hand.capsules()) world.removeCollisionObject(capsule.get());
  for (btMultiBodyConstraint* one : hand.constraints()) world.removeMultiBodyConstraint(one);
  world.removeMultiBody(&hand.body());
}

// Applies the settings of Bullet's own server (PhysicsServerCommandProcessor), which the paper
// used. They end the solver's sweeps when nothing changes any more.
void PaperEngine::configure(const SceneModel& scene) {
  world.setGravity(bullet::toBt(scene.gravity_m_s2));
  btContactSolverInfo& info = world.getSolverInfo();
  info.m_numIterations = 50;
  info.m_leastSquaresResidualThreshold = 1e-7;
  info.m_linearSlop = 1e-5;
  info.m_erp2 = 0.08;
  info.m_frictionERP = 0.2;
  info.m_warmstartingFactor = 0.1;
  // All islands are solved together, because the hand is one multibody but Bullet divides it into
  // parts. (Without islands Bullet 3.24 forgets motors.)
  info.m_minimumSolverBatchSize = std::numeric_limits<int>::max();
}

// Places every body in the hand at once, which is the worst case. Bullet's arrays then grow here,
// before a person is attached.
void PaperEngine::rehearse() {
  std::vector<btPersistentManifold*> manifolds;
  btCollisionObject* any = hand.capsules().front().get();
  while (static_cast<int>(manifolds.size()) < kReservedManifolds) {
    manifolds.push_back(dispatcher.getNewManifold(any, any));
  }
  for (btPersistentManifold* manifold : manifolds) dispatcher.releaseManifold(manifold);
  const btVector3 middle = hand.capsules().front()->getWorldTransform().getOrigin();
  for (PaperBody& body : bodies) body.putAt(middle);
  constexpr int kSteps = 2;
  for (int i = 0; i < kSteps; ++i) world.stepSimulation(1e-9, 0);
  for (PaperBody& body : bodies) body.putAtStart();
  setHand(AxisPosition(hand_model.axis_count), AxisVelocity(hand_model.axis_count));
  world.performDiscreteCollisionDetection();
  forgetContacts();
}

void PaperEngine::setHand(const AxisPosition& position, const AxisVelocity& velocity) noexcept {
  q_s = position;
  qd_s = velocity;
  hand.put(q_s, qd_s);
}

void PaperEngine::forgetContacts(int body) noexcept {
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    const bool its = body < 0 || bullet::tagOf(manifold.getBody0())->body == body ||
                     bullet::tagOf(manifold.getBody1())->body == body;
    if (its) manifold.clearManifold();
  }
}

Diagnostics PaperEngine::overlaps() {
  world.performDiscreteCollisionDetection();
  HandOverlaps found(bodies.size());
  bullet::addOverlaps(dispatcher, found);
  return found.refuse(hand_model, scene_path, body_names);
}

}  // namespace wholehand::bullet_paper
