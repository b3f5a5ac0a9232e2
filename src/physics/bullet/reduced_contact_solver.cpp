#include "physics/bullet/reduced_contact_solver.hpp"

#include "core/tick_record.hpp"
#include "physics/bullet/bullet_types.hpp"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

// A row whose effective inverse mass is below this moves nothing: the palm on a fixed body while
// the spin row has no joint to turn. Dividing by it gave NaN.
constexpr double kLeastInverseMass = 1e-12;
constexpr double kNoLimit = 1e30;
// More points than a record shows: what is not shown still pushes.
constexpr int kMostContacts = 4 * kMaxContacts;
constexpr int kNarrow = 8;  // axes that most devices do not exceed

// Four numbers at once. A vector of Bullet has a fourth, which is zero.
static_assert(kMaxLeaning == 4 && kMaxAxes % 4 == 0 && sizeof(btVector3) == 4 * sizeof(double));
Eigen::Map<Eigen::Vector4d> four(double* first) {
  return Eigen::Map<Eigen::Vector4d>(first);
}
Eigen::Map<const Eigen::Vector4d> four(const double* first) {
  return Eigen::Map<const Eigen::Vector4d>(first);
}
Eigen::Map<Eigen::Vector4d> four(btVector3& v) {
  return four(v.m_floats);
}
Eigen::Map<const Eigen::Vector4d> four(const btVector3& v) {
  return four(v.m_floats);
}

// True when friction is at its limit, or there is none because nothing presses.
bool slides(const HandContact& contact) {
  const double limit = contact.friction * contact.normal_row.impulse;
  return std::hypot(contact.tangent1_row.impulse, contact.tangent2_row.impulse) >=
         limit * (1.0 - 1e-9);
}

// Bullet keeps an anchored point until its friction is seen outside the cone, and ours never is. A
// point that slides must not be kept: it drifts past the contact threshold and is thrown away, and
// the step in which that happens has no contact at all (a fast thumb sank 12 mm into a box).
void letGoOfAnchor(btManifoldPoint& point) {
  constexpr double kOutside = 1.0 + 1e-6;
  constexpr double kAnything_ns = 1e-12;  // where both are zero
  point.m_appliedImpulseLateral1 = point.m_appliedImpulseLateral1 * kOutside + kAnything_ns;
  point.m_appliedImpulseLateral2 *= kOutside;
}

}  // namespace

ReducedContactSolver::ReducedContactSolver(const HandModel& hand, const ArticulatedBody& kinematics,
                                           HandRows& rows, const SolverSettings& settings)
    : axes_(hand.axis_count),
      settings_(settings),
      kinematics_(kinematics),
      rows_(rows),
      inverse_(AxisMatrix::Zero(axes_ <= kNarrow ? kNarrow : kMaxAxes,
                                axes_ <= kNarrow ? kNarrow : kMaxAxes)),
      contacts_(kMostContacts) {
  reserve();
}

void ReducedContactSolver::beginStep(const AxisMatrix& inverse, const AxisVelocity& velocity) {
  forgetStep();
  inverse_.topLeftCorner(axes_, axes_) = inverse;
  std::copy_n(velocity.data(), axes_, velocity_.data());
  change_.fill(0.0);
}

AxisVelocity ReducedContactSolver::velocity() const {
  AxisVelocity out(axes_);
  for (int a = 0; a < axes_; ++a) out[a] = velocity_[a] + change_[a];
  return out;
}

// The base class grows these arrays at first contacts; growing them here keeps the tick free of
// allocation. 512 rows are four times what a full scene of kMaxBodies was seen to need.
void ReducedContactSolver::reserve() {
  constexpr int kRows = 512;
  m_tmpSolverBodyPool.reserve(4 * kMaxBodies);
  m_tmpSolverContactConstraintPool.reserve(kRows);
  m_tmpSolverContactFrictionConstraintPool.reserve(2 * kRows);
  m_tmpSolverContactRollingFrictionConstraintPool.reserve(3 * kRows);
  m_orderTmpConstraintPool.reserve(kRows);
  m_orderNonContactConstraintPool.reserve(kRows);
  m_orderFrictionConstraintPool.reserve(2 * kRows);
  m_tmpConstraintSizesPool.reserve(kRows);
}

void ReducedContactSolver::convertContacts(btPersistentManifold** manifolds, int count,
                                           const btContactSolverInfo& info) {
  rows_.setUp(kinematics_, inverse_, velocity_.data(), info.m_timeStep);
  leans_ = rows_.leaning();
  for (int i = 0; i < count; ++i) {
    const ColliderTag& a = *tagOf(manifolds[i]->getBody0());
    const ColliderTag& b = *tagOf(manifolds[i]->getBody1());
    if (!a.ofHand() && !b.ofHand()) {
      convertBodyManifold(*manifolds[i], info);
    } else if (a.ofHand()) {
      convertHandManifold(*manifolds[i], a, b, true, info);
    } else {
      convertHandManifold(*manifolds[i], b, a, false, info);
    }
  }
  rows_.start(change_.data());
}

// The base class moves what a manifold names: for this call that is the bodies, not their
// colliders.
void ReducedContactSolver::convertBodyManifold(btPersistentManifold& manifold,
                                               const btContactSolverInfo& info) {
  const btCollisionObject* a = manifold.getBody0();
  const btCollisionObject* b = manifold.getBody1();
  manifold.setBodies(tagOf(a)->rigid, tagOf(b)->rigid);
  convertContact(&manifold, info);
  manifold.setBodies(a, b);
}

void ReducedContactSolver::convertHandManifold(btPersistentManifold& manifold,
                                               const ColliderTag& hand, const ColliderTag& body,
                                               bool hand_is_a, const btContactSolverInfo& info) {
  const int solver_body = getOrInitSolverBody(*body.rigid, info.m_timeStep);
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    btManifoldPoint& point = manifold.getContactPoint(k);
    if (point.getDistance() > manifold.getContactProcessingThreshold()) continue;
    if (contact_count_ == kMostContacts) {
      ++dropped_;
      continue;
    }
    HandContact& contact = contacts_[contact_count_++];
    contact.point = &point;
    contact.capsule = hand.capsule;
    contact.body = body.body;
    contact.solver_body = solver_body;
    contact.friction = point.m_combinedFriction;
    contact.normal = hand_is_a ? point.m_normalWorldOnB : -point.m_normalWorldOnB;
    contact.on_hand = hand_is_a ? point.getPositionWorldOnA() : point.getPositionWorldOnB();
    contact.distance_m = point.getDistance();
    setUpContact(contact, hand, *body.rigid,
                 hand_is_a ? point.getPositionWorldOnB() : point.getPositionWorldOnA(), info);
    warmStart(contact);
  }
}

void ReducedContactSolver::setUpContact(HandContact& contact, const ColliderTag& tag,
                                        const btRigidBody& owner, const btVector3& on_body,
                                        const btContactSolverInfo& info) {
  const btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
  const btRigidBody* rigid = body.m_originalBody;
  const btVector3 arm =
      rigid != nullptr ? on_body - rigid->getCenterOfMassPosition() : btVector3(0, 0, 0);
  const Eigen::Vector3d at = toEigen(contact.on_hand);
  const double step_s = info.m_timeStep;
  // As Bullet lays them for a new point, so that one that replaces an old one inherits its
  // impulses.
  btPlaneSpace1(contact.point->m_normalWorldOnB, contact.tangent1, contact.tangent2);

  const auto linear_row = [&](ReducedRow& row, const btVector3& direction, double goal) {
    kinematics_.reducedPointRow(tag.link, at, toEigen(direction), row.jacobian.data());
    row.linear = -direction;
    row.angular = arm.cross(-direction);
    // Bullet has one body for all that is fixed, and that one stands; this one may slide.
    if (rigid == nullptr) goal -= row.linear.dot(owner.getLinearVelocity());
    finishRow(row, body, false, goal, &row == &contact.normal_row);
  };
  // Apart: let them close the gap in this step and no further. Overlapping: push apart gently.
  const double gap = contact.distance_m + settings_.penetration_slop_m;
  const double goal = gap > 0.0 ? -gap / step_s : -gap * settings_.contact_erp / step_s;
  linear_row(contact.normal_row, contact.normal, goal);
  // Friction anchors: the two points were one when they first touched.
  const btVector3 drift = contact.on_hand - on_body;
  const double pull = -settings_.friction_anchor_erp / step_s;
  linear_row(contact.tangent1_row, contact.tangent1, pull * drift.dot(contact.tangent1));
  linear_row(contact.tangent2_row, contact.tangent2, pull * drift.dot(contact.tangent2));

  ReducedRow& spin = contact.spin_row;
  kinematics_.reducedAngularRow(tag.link, toEigen(contact.normal), spin.jacobian.data());
  spin.linear.setZero();
  spin.angular = -contact.normal;
  finishRow(spin, body, true, 0.0);
}

void ReducedContactSolver::finishRow(ReducedRow& row, const btSolverBody& body, bool angular,
                                     double goal_velocity, bool one_sided) const {
  if (axes_ <= kNarrow) {
    respond<kNarrow>(row);
  } else {
    respond<kMaxAxes>(row);
  }
  if (leans_) rows_.lean(row.jacobian, row.response, row.lean, one_sided);
  double inverse_mass = 0.0;
  double velocity = 0.0;
  for (int a = 0; a < axes_; ++a) {
    velocity += row.jacobian[a] * velocity_[a];
    inverse_mass += row.response[a] * row.jacobian[a];
  }
  const btRigidBody* rigid = body.m_originalBody;
  row.linear_response.setZero();
  row.angular_response.setZero();
  if (rigid != nullptr) {
    if (!angular) row.linear_response = row.linear * rigid->getInvMass();
    row.angular_response = rigid->getInvInertiaTensorWorld() * row.angular;
    inverse_mass += row.linear_response.dot(row.linear) + row.angular_response.dot(row.angular);
    velocity += row.linear.dot(body.m_linearVelocity + body.m_externalForceImpulse) +
                row.angular.dot(body.m_angularVelocity + body.m_externalTorqueImpulse);
  }
  row.effective_mass = inverse_mass > kLeastInverseMass ? 1.0 / inverse_mass : 0.0;
  row.target = (goal_velocity - velocity) * row.effective_mass;
  row.impulse = 0.0;
}

/// M_r⁻¹ j
template <int Width>
void ReducedContactSolver::respond(ReducedRow& row) const {
  using Axes = Eigen::Matrix<double, Width, 1>;
  Axes response = Axes::Zero();
  for (int a = 0; a < axes_; ++a) {
    response += row.jacobian[a] * Eigen::Map<const Axes>(inverse_.data() + a * Width);
  }
  Eigen::Map<Axes>(row.response.data()) = response;
}

// The point keeps its impulses and tangents from the step before; tangents may have turned.
void ReducedContactSolver::warmStart(HandContact& contact) {
  btManifoldPoint& point = *contact.point;
  const btVector3 old = point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
                        point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2;
  const double share = settings_.warm_start;
  btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
  apply<kMaxAxes>(contact.normal_row, body, share * point.m_appliedImpulse);
  apply<kMaxAxes>(contact.tangent1_row, body, share * old.dot(contact.tangent1));
  apply<kMaxAxes>(contact.tangent2_row, body, share * old.dot(contact.tangent2));
  apply<kMaxAxes>(contact.spin_row, body, share * point.m_prevRHS);
}

template <int Width>
double ReducedContactSolver::wanted(const ReducedRow& row, const btSolverBody& body) const {
  Eigen::Vector4d velocity = four(row.linear).cwiseProduct(four(body.m_deltaLinearVelocity)) +
                             four(row.angular).cwiseProduct(four(body.m_deltaAngularVelocity));
  for (int a = 0; a < Width; a += 4) {
    velocity += four(&row.jacobian[a]).cwiseProduct(four(&change_[a]));
  }
  return row.impulse + row.target - velocity.sum() * row.effective_mass;
}

template <int Width>
void ReducedContactSolver::apply(ReducedRow& row, btSolverBody& body, double impulse) {
  const double change = impulse - row.impulse;
  if (row.effective_mass == 0.0 || change == 0.0) return;
  row.impulse = impulse;
  residual_ = std::max(residual_, change * change);
  four(body.m_deltaLinearVelocity) += change * four(row.linear_response);
  four(body.m_deltaAngularVelocity) += change * four(row.angular_response);
  for (int a = 0; a < Width; a += 4) four(&change_[a]) += change * four(&row.response[a]);
  if (leans_) four(rows_.leaningImpulse().data()) += change * four(row.lean.data());
}

template <int Width>
void ReducedContactSolver::solveFriction(HandContact& contact) {
  btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
  const double normal = contact.normal_row.impulse;
  if (normal == 0.0) {  // nothing presses, nothing rubs
    apply<Width>(contact.spin_row, body, 0.0);
    apply<Width>(contact.tangent1_row, body, 0.0);
    apply<Width>(contact.tangent2_row, body, 0.0);
    return;
  }
  const double spin_limit = settings_.spinning_friction_m * normal;
  apply<Width>(contact.spin_row, body,
               std::clamp(wanted<Width>(contact.spin_row, body), -spin_limit, spin_limit));
  // Both tangents at once, so that friction is a disc and not a square.
  double t1 = wanted<Width>(contact.tangent1_row, body);
  double t2 = wanted<Width>(contact.tangent2_row, body);
  const double length = std::sqrt(t1 * t1 + t2 * t2);
  const double limit = contact.friction * normal;
  if (length > limit) {
    t1 *= limit / length;
    t2 *= limit / length;
  }
  apply<Width>(contact.tangent1_row, body, t1);
  apply<Width>(contact.tangent2_row, body, t2);
}

template <int Width>
void ReducedContactSolver::iterate() {
  for (int i = 0; i < contact_count_; ++i) {
    HandContact& contact = contacts_[i];
    btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
    apply<Width>(contact.normal_row, body,
                 std::clamp(wanted<Width>(contact.normal_row, body), 0.0, kNoLimit));
  }
  for (int i = 0; i < contact_count_; ++i) solveFriction<Width>(contacts_[i]);
  residual_ = std::max(residual_, rows_.iterate<Width>(change_.data()));
}

btScalar ReducedContactSolver::solveSingleIteration(
    int iteration, btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
    int manifold_count, btTypedConstraint** constraints, int constraint_count,
    const btContactSolverInfo& info, btIDebugDraw* drawer) {
  const btScalar others = btSequentialImpulseConstraintSolver::solveSingleIteration(
      iteration, bodies, body_count, manifolds, manifold_count, constraints, constraint_count, info,
      drawer);
  residual_ = 0.0;
  if (axes_ <= kNarrow) {
    iterate<kNarrow>();
  } else {
    iterate<kMaxAxes>();
  }
  // With 0 the base class would stop after its first iteration.
  return std::max(others, btScalar(residual_));
}

btScalar ReducedContactSolver::solveGroupCacheFriendlyFinish(btCollisionObject** bodies,
                                                             int body_count,
                                                             const btContactSolverInfo& info) {
  rows_.finish();
  for (int i = 0; i < contact_count_; ++i) {
    const HandContact& contact = contacts_[i];
    btManifoldPoint& point = *contact.point;
    point.m_appliedImpulse = contact.normal_row.impulse;
    point.m_appliedImpulseLateral1 = contact.tangent1_row.impulse;
    point.m_appliedImpulseLateral2 = contact.tangent2_row.impulse;
    if (slides(contact)) letGoOfAnchor(point);
    point.m_lateralFrictionDir1 = contact.tangent1;
    point.m_lateralFrictionDir2 = contact.tangent2;
    point.m_prevRHS = contact.spin_row.impulse;  // a free slot that lives with the point
  }
  return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(bodies, body_count,
                                                                            info);
}

}  // namespace wholehand::bullet
