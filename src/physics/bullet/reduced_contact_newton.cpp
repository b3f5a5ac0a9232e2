#include "physics/bullet/reduced_contact_solver.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <cmath>

// The hand's contacts solved at once, by ConeNewton: where the bodies that the hand touches are
// few, and touch nothing else.

namespace wholehand::bullet {

bool ReducedContactSolver::listIsland() {
  island_.clear();
  slot_.assign(m_tmpSolverBodyPool.size(), -1);
  for (int i = 0; i < contact_count_; ++i) {
    const int body = contacts_[i].solver_body;
    const btRigidBody* rigid = m_tmpSolverBodyPool[body].m_originalBody;
    if (rigid == nullptr || slot_[body] >= 0) continue;
    const int bodies = static_cast<int>(island_.size()) + 1;
    if (axes_ + 6 * bodies > ConeNewton::kMostUnknowns) return false;
    slot_[body] = bodies - 1;
    IslandBody& added = island_.emplace_back();
    added.solver_body = body;
    added.linear = std::sqrt(rigid->getInvMass());
    const btMatrix3x3& inverse = rigid->getInvInertiaTensorWorld();
    added.angular.factorize([&](int r, int c) { return inverse[r][c]; }, 3);
  }
  return true;
}

void ReducedContactSolver::writeRow(const ReducedRow& row, int body, ConeNewton::Row& out) const {
  root_.transpose(row.jacobian.data(), out.along.data());
  out.goal = row.lacking;
  out.start = row.impulse;
  if (slot_[body] < 0) return;
  const IslandBody& of = island_[slot_[body]];
  double* along = out.along.data() + axes_ + 6 * slot_[body];
  for (int i = 0; i < 3; ++i) along[i] = of.linear * row.linear[i];
  of.angular.transpose(row.angular.m_floats, along + 3);
}

bool ReducedContactSolver::solveAtOnce() {
  if (!settings_.at_once || body_rows_.anyNear()) return false;
  if (rows_.touchCount() > 0 || rows_.couplesEnds() || !listIsland()) return false;
  root_.factorize(inverse_, axes_);
  newton_.begin(axes_ + 6 * static_cast<int>(island_.size()));
  for (int i = 0; i < contact_count_; ++i) {
    const HandContact& contact = contacts_[i];
    ConeNewton::Row* rows = newton_.add(4, contact.friction, settings_.spinning_friction_m);
    if (rows == nullptr) return false;
    writeRow(contact.normal_row, contact.solver_body, rows[0]);
    writeRow(contact.tangent1_row, contact.solver_body, rows[1]);
    writeRow(contact.tangent2_row, contact.solver_body, rows[2]);
    writeRow(contact.spin_row, contact.solver_body, rows[3]);
  }
  if (!rows_.addEndsTo(newton_, root_) || !newton_.solve() || !withinBounds()) return false;
  takeImpulses();
  return true;
}

// A bound that holds couples the contacts of its body: sweeps keep it.
bool ReducedContactSolver::withinBounds() {
  for (int i = 0; i < contact_count_; ++i) {
    if (contacts_[i].bound != nullptr) contacts_[i].bound->pressed = 0.0;
  }
  for (int i = 0; i < contact_count_; ++i) {
    ImpulseBound* bound = contacts_[i].bound;
    if (bound == nullptr) continue;
    bound->pressed += newton_.row(4 * i).impulse;
    if (bound->pressed > bound->most) return false;
  }
  return true;
}

void ReducedContactSolver::takeImpulses() {
  for (int i = 0; i < contact_count_; ++i) {
    HandContact& contact = contacts_[i];
    contact.normal_row.impulse = newton_.row(4 * i).impulse;
    contact.tangent1_row.impulse = newton_.row(4 * i + 1).impulse;
    contact.tangent2_row.impulse = newton_.row(4 * i + 2).impulse;
    contact.spin_row.impulse = newton_.row(4 * i + 3).impulse;
  }
  rows_.takeEndsFrom(newton_, 4 * contact_count_);
  const double* change = newton_.change().data();
  root_.apply(change, change_.data());
  for (const IslandBody& of : island_) {
    btSolverBody& body = m_tmpSolverBodyPool[of.solver_body];
    change += of.solver_body == island_.front().solver_body ? axes_ : 6;
    body.m_deltaLinearVelocity = of.linear * btVector3(change[0], change[1], change[2]);
    of.angular.apply(change + 3, body.m_deltaAngularVelocity.m_floats);
  }
}

}  // namespace wholehand::bullet
