#include "core/vector_clones.hpp"
#include "physics/bullet/reduced_contact_solver.hpp"
#include "physics/bullet/row_arithmetic.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>
#include <utility>

// The sweeps of projected Gauss-Seidel over the rows: the hot loop of the tick.

namespace wholehand::bullet {
namespace {

constexpr double kNoLimit = 1e30;
constexpr double kSettled = 0.05;  // of the largest impulse

// A vector of Bullet has a fourth number, which is zero.
static_assert(kMaxCoupledEnds == 4 && kMaxAxes % 4 == 0 && sizeof(btVector3) == 4 * sizeof(double));

}  // namespace

/// Change of the velocity along a row in this step.
template <int Width>
double ReducedContactSolver::change(const ReducedRow& row, const btSolverBody& body) const {
  return alongRow<Width>(row.jacobian.data(), change_.data(), row.linear.m_floats,
                         body.m_deltaLinearVelocity.m_floats, row.angular.m_floats,
                         body.m_deltaAngularVelocity.m_floats);
}

template <int Width>
double ReducedContactSolver::wanted(const ReducedRow& row, const btSolverBody& body) const {
  return row.impulse + row.target - change<Width>(row, body) * row.effective_mass;
}

template <int Width>
void ReducedContactSolver::apply(ReducedRow& row, btSolverBody& body, double impulse) {
  const double change = impulse - row.impulse;
  if (row.effective_mass == 0.0 || change == 0.0) return;
  row.impulse = impulse;
  residual_ = std::max(residual_, change * change);
  addScaled<4>(body.m_deltaLinearVelocity.m_floats, change, row.linear_response.m_floats);
  addScaled<4>(body.m_deltaAngularVelocity.m_floats, change, row.angular_response.m_floats);
  addScaled<Width>(change_.data(), change, row.response.data());
  if (couples_ends_) addScaled<4>(rows_.coupledEndImpulse().data(), change, row.end_shares.data());
}

// Sets the normal impulse, within the bound of its body.
template <int Width>
void ReducedContactSolver::press(HandContact& contact, btSolverBody& body, double wanted) {
  if (contact.bound == nullptr) {
    apply<Width>(contact.normal_row, body, std::clamp(wanted, 0.0, kNoLimit));
    return;
  }
  ImpulseBound& bound = *contact.bound;
  const double before = contact.normal_row.impulse;
  const double most = std::max(0.0, bound.most - (bound.pressed - before));
  apply<Width>(contact.normal_row, body, std::clamp(wanted, 0.0, most));
  bound.pressed += contact.normal_row.impulse - before;
}

// Applies the impulses that the rows start from.
void ReducedContactSolver::start(HandContact& contact) {
  btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
  const auto first = [](ReducedRow& row) { return std::exchange(row.impulse, 0.0); };
  press<kMaxAxes>(contact, body, first(contact.normal_row));
  apply<kMaxAxes>(contact.tangent1_row, body, first(contact.tangent1_row));
  apply<kMaxAxes>(contact.tangent2_row, body, first(contact.tangent2_row));
  apply<kMaxAxes>(contact.spin_row, body, first(contact.spin_row));
}

// True when the friction of a contact pulls at a joint's end, which only presses.
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
  ReducedRow &one = contact.tangent1_row, &two = contact.tangent2_row;
  if (one.effective_mass == 0.0 || two.effective_mass == 0.0) {
    // Nothing moves along one of them.
    const double limit = contact.friction * normal;
    apply<Width>(one, body, std::clamp(wanted<Width>(one, body), -limit, limit));
    const double left = std::sqrt(std::max(0.0, limit * limit - one.impulse * one.impulse));
    apply<Width>(two, body, std::clamp(wanted<Width>(two, body), -left, left));
    return;
  }
  contact.disc.limit = contact.friction * normal;
  double t1 = 0.0, t2 = 0.0;
  contact.disc.solve(one.impulse, two.impulse, one.lacking - change<Width>(one, body),
                     two.lacking - change<Width>(two, body), t1, t2);
  apply<Width>(one, body, t1);
  apply<Width>(two, body, t2);
}

template <int Width>
void ReducedContactSolver::iterate() {
  for (int i = 0; i < contact_count_; ++i) {
    HandContact& contact = contacts_[i];
    btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
    const double yielded = contact.yielding * contact.normal_row.impulse;
    press<Width>(contact, body, wanted<Width>(contact.normal_row, body) - yielded);
  }
  for (int i = 0; i < contact_count_; ++i) {
    HandContact& contact = contacts_[i];
    solveFriction<Width>(contact);
    if (!contact.rests_on_ends || !pullsAtEnd(contact)) continue;
    // The end lets go, and the digit is light: with the inertia of the hand that an end holds
    // friction would overshoot from one side of its cone to the other, for ever.
    contact.rests_on_ends = false;
    finishFriction(contact, Ends::kFree);
  }
  residual_ = std::max(residual_, rows_.iterate<Width>(change_.data()));
}

// What slides begins anew. What friction holds has crept by what the solver left of its slip.
void ReducedContactSolver::keepDrift(HandContact& contact, double step_s) const {
  const double limit = contact.friction * contact.normal_row.impulse;
  const ReducedRow &one = contact.tangent1_row, &two = contact.tangent2_row;
  if (std::hypot(one.impulse, two.impulse) >= limit * (1.0 - 1e-9)) {
    contact.drift1_m = contact.drift2_m = 0.0;
    return;
  }
  const btSolverBody& body = m_tmpSolverBodyPool[contact.solver_body];
  const double pull = -settings_.friction_anchor_erp / step_s;
  const auto creep = [&](const ReducedRow& row, double drift_m) {
    return step_s * (pull * drift_m - row.lacking + change<kMaxAxes>(row, body));
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

// In place of the base class's iteration, which would sweep its own rows.
btScalar ReducedContactSolver::solveSingleIteration(
    int iteration, btCollisionObject** /*bodies*/, int /*body_count*/,
    btPersistentManifold** /*manifolds*/, int /*manifold_count*/,
    btTypedConstraint** /*constraints*/, int /*constraint_count*/,
    const btContactSolverInfo& /*info*/, btIDebugDraw* /*drawer*/) {
  if (iteration == 0) {
    near_unsettled_ = far_unsettled_ = false;
    body_rows_.begin(m_tmpSolverBodyPool, touched_);
    far_done_ = !body_rows_.any();
    at_once_ = solveAtOnce();
    if (!at_once_) prepareSweeps();
  }
  const bool far = !far_done_ && body_rows_.any();
  double others = joints_.solve(m_tmpSolverBodyPool);
  if (far) {
    others = std::max(others, body_rows_.sweepAll(m_tmpSolverBodyPool));
    const int most = std::clamp(kFarBudget / body_rows_.groups(), kLeastFarSweeps, kMostFarSweeps);
    far_done_ = iteration + 1 >= most || others <= settings_.far_tolerance * body_rows_.pressed();
    far_unsettled_ = far_done_ && others > kSettled * body_rows_.pressed();
  }
  const int sweeps = body_rows_.nearUneven() ? kUnevenSweeps : settings_.iterations;
  if (at_once_ || iteration >= sweeps) return far_done_ ? 0.0 : 1.0;
  if (!far) others = std::max(others, body_rows_.sweepNear(m_tmpSolverBodyPool));
  residual_ = 0.0;
  if (axes_ <= kNarrow) {
    iterateNarrow();
  } else {
    iterateWide();
  }
  if (iteration + 1 == sweeps) near_unsettled_ = changesStill();
  // With 0 the base class stops.
  return std::max(others, residual_);
}

}  // namespace wholehand::bullet
