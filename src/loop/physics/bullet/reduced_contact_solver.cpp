#include "loop/physics/bullet/reduced_contact_solver.hpp"

#include "loop/core/compiler.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/row_arithmetic.hpp"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>
#include <utility>

// This file contains the sweeps of projected Gauss-Seidel over the rows: the hot loop of the tick.

namespace wholehand::bullet {
namespace {

// A row whose inverse mass is below this moves nothing and is switched off: for example the spin
// row of a palm on a fixed body, which turns no joint. Dividing by it gave NaN.
constexpr double kLeastInverseMass = 1e-12;
// Largest number of contact points in the solver. It exceeds that of a record: points that are not
// recorded still push.
constexpr int kMostContacts = 4 * kMaxContacts;

}  // namespace

ReducedContactSolver::ReducedContactSolver(const HandModel& hand, const ArticulatedBody& kinematics,
                                           HandRows& rows, const SolverSettings& settings,
                                           int bodies)
    : axes_(hand.axis_count),
      settings_(settings),
      kinematics_(kinematics),
      rows_(rows),
      inverse_(AxisMatrix::Zero(axes_ <= kNarrow ? kNarrow : kMaxAxes,
                                axes_ <= kNarrow ? kNarrow : kMaxAxes)),
      contacts_(kMostContacts),
      bounded_(bodies),
      bounds_(bodies),
      newton_(settings.newton),
      body_rows_(mostBodyContacts(bodies), mostSolverBodies(bodies)) {
  reserve(bodies);
}

void ReducedContactSolver::beginStep(const AxisMatrix& inverse, const AxisVelocity& velocity) {
  forgetStep();
  inverse_.topLeftCorner(axes_, axes_) = inverse;
  std::copy_n(velocity.data(), axes_, velocity_.data());
  change_.fill(0.0);
}

double ReducedContactSolver::impulseOn(int body) const noexcept {
  double sum_ns = 0.0;
  for (int i = 0; i < contact_count_; ++i) {
    if (contacts_[i].body == body) sum_ns += contacts_[i].normal_row.impulse;
  }
  return sum_ns;
}

AxisVelocity ReducedContactSolver::velocity() const {
  AxisVelocity out(axes_);
  for (int a = 0; a < axes_; ++a) out[a] = velocity_[a] + change_[a];
  return out;
}

// Sized from an observation: boxes in stacks side by side needed 10 contacts each.
int ReducedContactSolver::mostBodyContacts(int bodies) {
  return std::max(512, 16 * bodies);
}
int ReducedContactSolver::mostSolverBodies(int bodies) {
  return std::max(128, 2 * bodies);
}

// The base class grows these arrays at the first contacts; reserving them here keeps allocation out
// of the tick.
void ReducedContactSolver::reserve(int bodies) {
  m_tmpSolverBodyPool.reserve(mostSolverBodies(bodies));
  slot_.reserve(mostSolverBodies(bodies));
  island_.reserve(ConeNewton::kMostUnknowns / 6);
  touched_.resize(mostSolverBodies(bodies));
  by_hand_.resize(touched_.size());
}

void ReducedContactSolver::convertContacts(btPersistentManifold** manifolds, int count,
                                           const btContactSolverInfo& info) {
  rows_.setUp(kinematics_, inverse_, velocity_.data(), info.m_timeStep);
  softness_ =
      settings_.contact_erp / (settings_.contact_stiffness_n_m * info.m_timeStep * info.m_timeStep);
  sweeps_ = sweepsOfHand(settings_, info.m_timeStep);
  couples_ends_ = rows_.couplesEnds();
  bool others = false;
  for (int i = 0; i < count; ++i) {
    const ColliderTag& a = *tagOf(manifolds[i]->getBody0());
    const ColliderTag& b = *tagOf(manifolds[i]->getBody1());
    if (!a.ofHand() && !b.ofHand()) {
      others = true;
    } else if (a.ofHand()) {
      convertHandManifold(*manifolds[i], a, b, true, info);
    } else {
      convertHandManifold(*manifolds[i], b, a, false, info);
    }
  }
  body_rows_.clear();
  findTouched();
  for (int i = 0; others && i < count; ++i) {
    const bool of_hand =
        tagOf(manifolds[i]->getBody0())->ofHand() || tagOf(manifolds[i]->getBody1())->ofHand();
    if (!of_hand) convertBodyManifold(*manifolds[i], info);
  }
}

void ReducedContactSolver::findTouched() {
  std::fill(touched_.begin(), touched_.end(), false);
  for (int i = 0; i < contact_count_; ++i) {
    const int body = contacts_[i].solver_body;
    touched_[body] = m_tmpSolverBodyPool[body].m_originalBody != nullptr;
  }
  by_hand_ = touched_;
  joints_.begin(touched_);
}

void ReducedContactSolver::convertBodyManifold(btPersistentManifold& manifold,
                                               const btContactSolverInfo& info) {
  if (manifold.getNumContacts() > body_rows_.room()) {
    dropped_ += manifold.getNumContacts();
    return;
  }
  const ContactGoals goals{info.m_timeStep,           settings_.penetration_slop_m,
                           settings_.contact_erp,     settings_.body_push_m_s,
                           settings_.body_warm_start, info.m_restitutionVelocityThreshold};
  const int a = getOrInitSolverBody(leadOf(*tagOf(manifold.getBody0())->rigid), info.m_timeStep);
  const int b = getOrInitSolverBody(leadOf(*tagOf(manifold.getBody1())->rigid), info.m_timeStep);
  body_rows_.add(manifold, a, b, goals, m_tmpSolverBodyPool, touched_);
}

void ReducedContactSolver::convertHandManifold(btPersistentManifold& manifold,
                                               const ColliderTag& hand, const ColliderTag& body,
                                               bool hand_is_a, const btContactSolverInfo& info) {
  const int solver_body = getOrInitSolverBody(leadOf(*body.rigid), info.m_timeStep);
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
    contact.bound = bounded_[body.body] ? &bounds_[body.body] : nullptr;
    setUpContact(contact, hand, *body.rigid,
                 hand_is_a ? point.getPositionWorldOnB() : point.getPositionWorldOnA(), info);
    startFromLast(contact, info.m_timeStep);
  }
}

void ReducedContactSolver::setUpContact(HandContact& contact, const ColliderTag& tag,
                                        const btRigidBody& owner, const btVector3& on_body,
                                        const btContactSolverInfo& info) {
  const btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
  const btRigidBody* rigid = body.m_originalBody;
  const btVector3 arm =
      rigid != nullptr ? on_body - owner.getCenterOfMassPosition() : btVector3(0, 0, 0);
  const SolverJoint* on = rigid != nullptr ? jointOf(owner) : nullptr;
  const Eigen::Vector3d at = toEigen(contact.on_hand);
  const double step_s = info.m_timeStep;
  // Chooses the tangents as Bullet does for a new point, so that a point that replaces an old one
  // inherits its impulses.
  btPlaneSpace1(contact.point->m_normalWorldOnB, contact.tangent1, contact.tangent2);

  kinematics_.reducedContactRows(
      tag.link, at, {toEigen(contact.normal), toEigen(contact.tangent1), toEigen(contact.tangent2)},
      {contact.normal_row.jacobian.data(), contact.tangent1_row.jacobian.data(),
       contact.tangent2_row.jacobian.data(), contact.spin_row.jacobian.data()});
  const auto linear_row = [&](ReducedRow& row, const btVector3& direction, double goal) {
    row.linear = -direction;
    row.angular = arm.cross(-direction);
    // Bullet uses one body at rest for everything that is fixed; a fixed body may slide, so its
    // velocity is subtracted here.
    if (rigid == nullptr) goal -= row.linear.dot(owner.getLinearVelocity());
    aim(row, body, on, goal);
  };
  // Apart: the gap may close in this step, but no overlap may begin. Overlapping: pushes apart
  // gently.
  const double gap = contact.distance_m + settings_.penetration_slop_m;
  const double goal = gap > 0.0 ? -gap / step_s : -gap * settings_.contact_erp / step_s;
  linear_row(contact.normal_row, contact.normal, goal);
  const btManifoldPoint& point = *contact.point;
  const btVector3 drift = point.m_lateralFrictionDir1 * point.m_contactMotion1 +
                          point.m_lateralFrictionDir2 * point.m_contactMotion2;
  contact.drift1_m = drift.dot(contact.tangent1);
  contact.drift2_m = drift.dot(contact.tangent2);
  const double pull = -settings_.friction_anchor_erp / step_s;
  linear_row(contact.tangent1_row, contact.tangent1, pull * contact.drift1_m);
  linear_row(contact.tangent2_row, contact.tangent2, pull * contact.drift2_m);

  ReducedRow& spin = contact.spin_row;
  spin.linear.setZero();
  spin.angular = -contact.normal;
  aim(spin, body, on, 0.0);
}

void ReducedContactSolver::aim(ReducedRow& row, const btSolverBody& body, const SolverJoint* on,
                               double goal_velocity) const {
  double velocity = 0.0;
  for (int a = 0; a < axes_; ++a) velocity += row.jacobian[a] * velocity_[a];
  if (on != nullptr) {
    projectOnJoint(*on, row.linear, row.angular);
    velocity += rateAlong(*on, row.angular);
  } else if (body.m_originalBody != nullptr) {
    velocity += row.linear.dot(body.m_linearVelocity + body.m_externalForceImpulse) +
                row.angular.dot(body.m_angularVelocity + body.m_externalTorqueImpulse);
  }
  row.lacking = goal_velocity - velocity;
}

// Sets the starting impulses. The point keeps its impulses and tangents from the last step; the
// tangents may have rotated since. What a normal against a wall does not keep is replaced by the
// impulse that the depth implies at rest, so that a wedged hand at rest starts from the solution.
void ReducedContactSolver::startFromLast(HandContact& contact, double step_s) const {
  const btManifoldPoint& point = *contact.point;
  const btVector3 old = point.m_lateralFrictionDir1 * point.m_appliedImpulseLateral1 +
                        point.m_lateralFrictionDir2 * point.m_appliedImpulseLateral2;
  const btRigidBody* body = m_tmpSolverBodyPool[contact.solver_body].m_originalBody;
  bool wall = body == nullptr || body->getInvMass() == 0.0;
  // A joint is a wall where its end bears this contact.
  const SolverJoint* on = wall ? nullptr : jointOf(*body);
  if (on != nullptr) wall = joints_.endBears(*on, contact.normal_row.angular);
  const double share = settings_.warm_start;
  const double depth_m = std::max(0.0, -contact.distance_m - settings_.penetration_slop_m);
  const double at_rest = settings_.contact_stiffness_n_m * step_s * depth_m;
  const double kept = settings_.wall_warm_start;
  contact.normal_row.impulse = wall ? kept * point.m_appliedImpulse + (1.0 - kept) * at_rest
                                    : share * point.m_appliedImpulse;
  contact.lead = wall ? contact.normal_row.impulse - point.m_appliedImpulse : 0.0;
  contact.tangent1_row.impulse = share * old.dot(contact.tangent1);
  contact.tangent2_row.impulse = share * old.dot(contact.tangent2);
  contact.spin_row.impulse = share * point.m_prevRHS;
}

void ReducedContactSolver::prepareSweeps() {
  for (ImpulseBound& bound : bounds_) bound.pressed = 0.0;
  EndShares lead{};
  for (int i = 0; i < contact_count_; ++i) {
    HandContact& contact = contacts_[i];
    const btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
    finishRow(contact.normal_row, body, false, Ends::kPressed, softness_);
    contact.yielding = softness_ * contact.normal_row.effective_mass;
    contact.rests_on_ends = couples_ends_;
    finishFriction(contact, couples_ends_ ? Ends::kHeld : Ends::kFree);
    for (int k = 0; couples_ends_ && k < kMaxCoupledEnds; ++k) {
      lead[k] += contact.normal_row.end_shares[k] * contact.lead;
    }
    start(contact);
  }
  rows_.start(lead, change_.data());
  const auto in_use = contacts_.begin() + contact_count_;
  one_body_ = contact_count_ > 0 && !couples_ends_ &&
              std::all_of(contacts_.begin(), in_use, [&](const HandContact& contact) {
                return contact.solver_body == contacts_[0].solver_body;
              });
}

void ReducedContactSolver::finishFriction(HandContact& contact, Ends ends) const {
  const btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
  finishRow(contact.tangent1_row, body, false, ends);
  finishRow(contact.tangent2_row, body, false, ends);
  finishRow(contact.spin_row, body, true, ends);
  const ReducedRow &one = contact.tangent1_row, &two = contact.tangent2_row;
  if (one.effective_mass == 0.0 || two.effective_mass == 0.0) return;
  FrictionDisc<double>& disc = contact.disc;
  disc.yield_12 = one.linear.dot(two.linear_response) + one.angular.dot(two.angular_response);
  for (int a = 0; a < axes_; ++a) disc.yield_12 += one.jacobian[a] * two.response[a];
  // Keeps the matrix definite where one axis alone moves both tangents.
  constexpr double kDefinite = 1.0 + 1e-9;
  disc.yield_11 = kDefinite / one.effective_mass;
  disc.yield_22 = kDefinite / two.effective_mass;
  const double det = disc.yield_11 * disc.yield_22 - disc.yield_12 * disc.yield_12;
  disc.mass_11 = disc.yield_22 / det;
  disc.mass_12 = -disc.yield_12 / det;
  disc.mass_22 = disc.yield_11 / det;
}

void ReducedContactSolver::finishRow(ReducedRow& row, const btSolverBody& body, bool angular,
                                     Ends ends, double softness) const {
  if (axes_ <= kNarrow) {
    respond<kNarrow>(row);
  } else {
    respond<kMaxAxes>(row);
  }
  row.end_shares.fill(0.0);
  if (couples_ends_ && ends != Ends::kFree) {
    rows_.coupleToEnds(row.jacobian, row.response, row.end_shares, ends == Ends::kPressed);
  }
  double inverse_mass = 0.0;
  for (int a = 0; a < axes_; ++a) {
    inverse_mass += row.response[a] * row.jacobian[a];
  }
  const btRigidBody* rigid = body.m_originalBody;
  row.linear_response.setZero();
  row.angular_response.setZero();
  if (rigid != nullptr) {
    const Mobility mobility = mobilityOf(*rigid);
    if (!angular) row.linear_response = row.linear * mobility.linear;
    row.angular_response = mobility.angular * row.angular;
    inverse_mass += row.linear_response.dot(row.linear) + row.angular_response.dot(row.angular);
  }
  row.effective_mass = inverse_mass > kLeastInverseMass ? 1.0 / (inverse_mass + softness) : 0.0;
  row.target = row.lacking * row.effective_mass;
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

btScalar ReducedContactSolver::solveGroupCacheFriendlyFinish(btCollisionObject** bodies,
                                                             int body_count,
                                                             const btContactSolverInfo& info) {
  if (body_rows_.anyTouchedIsland()) solveTouched();
  rows_.finish();
  body_rows_.write(m_tmpSolverBodyPool);
  for (int i = 0; i < contact_count_; ++i) {
    HandContact& contact = contacts_[i];
    keepDrift(contact, info.m_timeStep);
    btManifoldPoint& point = *contact.point;
    point.m_appliedImpulse = contact.normal_row.impulse;
    point.m_appliedImpulseLateral1 = contact.tangent1_row.impulse;
    point.m_appliedImpulseLateral2 = contact.tangent2_row.impulse;
    point.m_contactMotion1 = contact.drift1_m;
    point.m_contactMotion2 = contact.drift2_m;
    point.m_lateralFrictionDir1 = contact.tangent1;
    point.m_lateralFrictionDir2 = contact.tangent2;
    // An unused field of Bullet's point keeps the spin impulse.
    point.m_prevRHS = contact.spin_row.impulse;
  }
  return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(bodies, body_count,
                                                                            info);
}

namespace {

constexpr double kNoLimit = 1e30;
constexpr double kSettled = 0.05;  // largest change of an impulse, relative to the largest impulse

// A Bullet vector has a fourth number, which is zero.
static_assert(kMaxCoupledEnds == 4 && kMaxAxes % 4 == 0 && sizeof(btVector3) == 4 * sizeof(double));

}  // namespace

template <int Width>
MemoryVelocities<Width> ReducedContactSolver::velocitiesAt(const HandContact& contact) {
  btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
  return {change_.data(), body.m_deltaLinearVelocity.m_floats, body.m_deltaAngularVelocity.m_floats,
          couples_ends_ ? rows_.coupledEndImpulse().data() : nullptr};
}

template <class Velocities>
double ReducedContactSolver::wanted(const ReducedRow& row, const Velocities& velocities) const {
  return row.impulse + row.target - velocities.along(row) * row.effective_mass;
}

template <class Velocities>
void ReducedContactSolver::apply(ReducedRow& row, Velocities& velocities, double impulse) {
  const double change = impulse - row.impulse;
  if (row.effective_mass == 0.0 || change == 0.0) return;
  row.impulse = impulse;
  residual_ = std::max(residual_, change * change);
  velocities.add(row, change);
}

// Sets the normal impulse within the bound of its body.
template <class Velocities>
void ReducedContactSolver::press(HandContact& contact, Velocities& velocities, double wanted) {
  if (contact.bound == nullptr) {
    apply(contact.normal_row, velocities, std::clamp(wanted, 0.0, kNoLimit));
    return;
  }
  ImpulseBound& bound = *contact.bound;
  const double before = contact.normal_row.impulse;
  const double most = std::max(0.0, bound.most - (bound.pressed - before));
  apply(contact.normal_row, velocities, std::clamp(wanted, 0.0, most));
  bound.pressed += contact.normal_row.impulse - before;
}

// Applies the starting impulses of the rows.
void ReducedContactSolver::start(HandContact& contact) {
  MemoryVelocities<kMaxAxes> velocities = velocitiesAt<kMaxAxes>(contact);
  const auto first = [](ReducedRow& row) { return std::exchange(row.impulse, 0.0); };
  press(contact, velocities, first(contact.normal_row));
  apply(contact.tangent1_row, velocities, first(contact.tangent1_row));
  apply(contact.tangent2_row, velocities, first(contact.tangent2_row));
  apply(contact.spin_row, velocities, first(contact.spin_row));
}

// True when the friction of a contact pulls at a joint's end. An end can only press.
bool ReducedContactSolver::pullsAtEnd(const HandContact& contact) const {
  const EndShares& borne = rows_.coupledEndImpulse();
  for (int k = 0; k < kMaxCoupledEnds; ++k) {
    if (borne[k] < 0.0 &&
        (contact.tangent1_row.end_shares[k] != 0.0 || contact.tangent2_row.end_shares[k] != 0.0 ||
         contact.spin_row.end_shares[k] != 0.0)) {
      return true;
    }
  }
  return false;
}

template <class Velocities>
void ReducedContactSolver::solveFriction(HandContact& contact, Velocities& velocities) {
  const double normal = contact.normal_row.impulse;
  if (normal == 0.0) {  // no friction without a normal impulse
    apply(contact.spin_row, velocities, 0.0);
    apply(contact.tangent1_row, velocities, 0.0);
    apply(contact.tangent2_row, velocities, 0.0);
    return;
  }
  const double spin_limit = settings_.spinning_friction_m * normal;
  apply(contact.spin_row, velocities,
        std::clamp(wanted(contact.spin_row, velocities), -spin_limit, spin_limit));
  ReducedRow &one = contact.tangent1_row, &two = contact.tangent2_row;
  if (one.effective_mass == 0.0 || two.effective_mass == 0.0) {
    // Nothing moves along one of the tangents, so each is limited separately.
    const double limit = contact.friction * normal;
    apply(one, velocities, std::clamp(wanted(one, velocities), -limit, limit));
    const double left = std::sqrt(std::max(0.0, limit * limit - one.impulse * one.impulse));
    apply(two, velocities, std::clamp(wanted(two, velocities), -left, left));
    return;
  }
  contact.disc.limit = contact.friction * normal;
  double t1 = 0.0, t2 = 0.0;
  contact.disc.solve(one.impulse, two.impulse, one.lacking - velocities.along(one),
                     two.lacking - velocities.along(two), t1, t2);
  apply(one, velocities, t1);
  apply(two, velocities, t2);
}

template <class Velocities>
void ReducedContactSolver::pressAgain(HandContact& contact, Velocities& velocities) {
  const double yielded = contact.yielding * contact.normal_row.impulse;
  press(contact, velocities, wanted(contact.normal_row, velocities) - yielded);
}

template <int Width>
void ReducedContactSolver::iterate() {
  if (one_body_) {
    btSolverBody& body = m_tmpSolverBodyPool[contacts_[0].solver_body];
    double *linear = body.m_deltaLinearVelocity.m_floats,
           *angular = body.m_deltaAngularVelocity.m_floats;
    RegisterVelocities<Width> velocities(change_.data(), linear, angular);
    for (int i = 0; i < contact_count_; ++i) pressAgain(contacts_[i], velocities);
    for (int i = 0; i < contact_count_; ++i) solveFriction(contacts_[i], velocities);
    velocities.write(change_.data(), linear, angular);
  } else {
    iterateAmongBodies<Width>();
  }
  residual_ = std::max(residual_, rows_.iterate<Width>(change_.data()));
}

template <int Width>
void ReducedContactSolver::iterateAmongBodies() {
  for (int i = 0; i < contact_count_; ++i) {
    MemoryVelocities<Width> velocities = velocitiesAt<Width>(contacts_[i]);
    pressAgain(contacts_[i], velocities);
  }
  for (int i = 0; i < contact_count_; ++i) {
    HandContact& contact = contacts_[i];
    MemoryVelocities<Width> velocities = velocitiesAt<Width>(contact);
    solveFriction(contact, velocities);
    if (!contact.rests_on_ends || !pullsAtEnd(contact)) continue;
    // The end no longer bears this contact's friction, and the digit alone is light. With the
    // inertia of a hand held by the end, friction would overshoot from one side of its cone to the
    // other forever.
    contact.rests_on_ends = false;
    finishFriction(contact, Ends::kFree);
  }
}

// Updates the drift. A sliding contact starts again from zero. A sticking one has crept by the slip
// that the solver left.
void ReducedContactSolver::keepDrift(HandContact& contact, double step_s) {
  const double limit = contact.friction * contact.normal_row.impulse;
  const ReducedRow &one = contact.tangent1_row, &two = contact.tangent2_row;
  if (std::hypot(one.impulse, two.impulse) >= limit * (1.0 - 1e-9)) {
    contact.drift1_m = contact.drift2_m = 0.0;
    return;
  }
  const MemoryVelocities<kMaxAxes> velocities = velocitiesAt<kMaxAxes>(contact);
  const double pull = -settings_.friction_anchor_erp / step_s;
  const auto creep = [&](const ReducedRow& row, double drift_m) {
    return step_s * (pull * drift_m - row.lacking + velocities.along(row));
  };
  contact.drift1_m += creep(one, contact.drift1_m);
  contact.drift2_m += creep(two, contact.drift2_m);
}

WHOLEHAND_VECTOR_CLONES void ReducedContactSolver::iterateNarrow() {
  iterate<kNarrow>();
}
WHOLEHAND_VECTOR_CLONES void ReducedContactSolver::iterateWide() {
  iterate<kMaxAxes>();
}

bool ReducedContactSolver::changesStill() const {
  double pressed = 0.0;
  for (int i = 0; i < contact_count_; ++i) {
    pressed = std::max(pressed, contacts_[i].normal_row.impulse);
  }
  return contact_count_ > 0 && residual_ > kSettled * kSettled * pressed * pressed;
}

// Replaces the base class's iteration, which would sweep its own rows.
btScalar ReducedContactSolver::solveSingleIteration(
    int iteration, btCollisionObject** /*bodies*/, int /*body_count*/,
    btPersistentManifold** /*manifolds*/, int /*manifold_count*/,
    btTypedConstraint** /*constraints*/, int /*constraint_count*/,
    const btContactSolverInfo& /*info*/, btIDebugDraw* /*drawer*/) {
  if (iteration == 0) {
    near_unsettled_ = far_unsettled_ = false;
    body_rows_.begin(m_tmpSolverBodyPool, touched_);
    body_rows_.solveIslands(m_tmpSolverBodyPool, by_hand_, joints_);
    far_done_ = !body_rows_.anyToSweep();
    at_once_ = solveAtOnce();
    if (!at_once_) prepareSweeps();
  }
  const bool far = !far_done_;
  double others = joints_.any() ? joints_.solve(m_tmpSolverBodyPool) : 0.0;
  if (far) {
    others = std::max(others, body_rows_.sweepAll(m_tmpSolverBodyPool));
    const int most = std::clamp(kFarBudget / body_rows_.groups(), kLeastFarSweeps, kMostFarSweeps);
    far_done_ = iteration + 1 >= most || others <= settings_.far_tolerance * body_rows_.pressed();
    far_unsettled_ = far_done_ && others > kSettled * body_rows_.pressed();
  }
  const int sweeps = std::max(sweeps_, body_rows_.nearUneven() ? kUnevenSweeps : 0);
  if (at_once_ || iteration >= sweeps) return far_done_ ? 0.0 : 1.0;
  if (!far) others = std::max(others, body_rows_.sweepNear(m_tmpSolverBodyPool));
  residual_ = 0.0;
  if (axes_ <= kNarrow) {
    iterateNarrow();
  } else {
    iterateWide();
  }
  if (iteration + 1 == sweeps) near_unsettled_ = changesStill();
  // The base class stops when this returns 0.
  return std::max(others, residual_);
}

}  // namespace wholehand::bullet
