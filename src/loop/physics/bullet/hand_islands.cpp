#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/reduced_contact_solver.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

// Direct solutions of the hand's contacts, in place of the sweeps: with the only island of several
// bodies that it touches by IslandNewton, or with few bodies that touch no others by ConeNewton.

namespace wholehand::bullet {

// Adds the hand's contacts and joint ends: per contact a cone, and a box for its spin.
bool ReducedContactSolver::addHandTo(IslandNewton& newton, int island, int slot) {
  for (int i = 0; i < contact_count_; ++i) {
    const HandContact& contact = contacts_[i];
    const bool moves = m_tmpSolverBodyPool[contact.solver_body].m_originalBody != nullptr;
    const int of = moves ? body_rows_.slotIn(island, contact.solver_body) : -1;
    if (moves && of < 0) return false;
    const auto write = [&](const ReducedRow& row, int r, IslandNewton::Contact& to) {
      root_.transpose(row.jacobian.data(), to.along_b[r].data());
      if (of >= 0) body_rows_.writeHandRow(of, row.linear, row.angular, to.along_a[r]);
      to.goal[r] = row.lacking;
      to.start[r] = row.impulse;
    };
    const int index = newton.contactCount();
    IslandNewton::Contact* cone = newton.add(of, slot);
    IslandNewton::Contact* spin = cone != nullptr ? newton.add(of, slot) : nullptr;
    if (spin == nullptr) return false;
    cone->friction = contact.friction;
    cone->yields = softness_;
    write(contact.normal_row, 0, *cone);
    write(contact.tangent1_row, 1, *cone);
    write(contact.tangent2_row, 2, *cone);
    write(contact.spin_row, 1, *spin);
    spin->of_joint = true;
    spin->spins = index;
    spin->spin_m = settings_.spinning_friction_m;
    spin->box = spin->spin_m * contact.normal_row.impulse;
  }
  return rows_.addEndsTo(newton, slot, root_);
}

void ReducedContactSolver::takeHandFrom(const IslandNewton& newton, int first, int slot) {
  for (int i = 0; i < contact_count_; ++i) {
    HandContact& contact = contacts_[i];
    const IslandNewton::Contact &cone = newton.contact(first + 2 * i),
                                &spin = newton.contact(first + 2 * i + 1);
    const double normal = cone.impulse[0];
    // The limit of the last but one normal impulse may exceed this one's by its tolerance.
    const double rubs = std::hypot(cone.impulse[1], cone.impulse[2]);
    const double share = std::min(1.0, contact.friction * normal / std::max(rubs, 1e-300));
    const double most_spin = settings_.spinning_friction_m * normal;
    contact.normal_row.impulse = normal;
    contact.tangent1_row.impulse = share * cone.impulse[1];
    contact.tangent2_row.impulse = share * cone.impulse[2];
    contact.spin_row.impulse = std::clamp(spin.impulse[1], -most_spin, most_spin);
  }
  rows_.takeEndsFrom(newton, first + 2 * contact_count_);
  root_.apply(newton.change(slot).data(), change_.data());
}

// Solves the only island of several bodies that the hand touches, together with the hand. Returns
// false where the hand has rows that this solution does not know, or none was found.
bool ReducedContactSolver::solveWithHand(int island) {
  if (island < 0 || axes_ > IslandNewton::kSize || rows_.touchCount() > 0) return false;
  for (int i = 0; i < contact_count_; ++i) {
    if (contacts_[i].bound != nullptr) return false;
  }
  const int slot = body_rows_.beginWithHand(island, m_tmpSolverBodyPool);
  if (slot < 0) return false;
  IslandNewton& newton = body_rows_.islandNewton();
  const int first = newton.contactCount();
  root_.factorize(inverse_, axes_);
  if (!addHandTo(newton, island, slot) || !body_rows_.solveBegun()) return false;
  takeHandFrom(newton, first, slot);
  body_rows_.takeWithHand(island, m_tmpSolverBodyPool, joints_);
  return true;
}

// A light body between the hand and others yields by its own mobility in a sweep, not by theirs:
// the hand's force would follow its depth too late.
void ReducedContactSolver::solveTouched() {
  if (solveWithHand(body_rows_.onlyTouchedIsland())) return;
  for (int i = 0; i < contact_count_; ++i) {
    const HandContact& contact = contacts_[i];
    for (const ReducedRow* row :
         {&contact.normal_row, &contact.tangent1_row, &contact.tangent2_row, &contact.spin_row}) {
      body_rows_.addHand(contact.solver_body, row->impulse * row->linear_response,
                         row->impulse * row->angular_response);
    }
  }
  body_rows_.solveTouched(m_tmpSolverBodyPool, joints_);
}

// Direct solution of the hand's contacts by ConeNewton, used when the hand touches few bodies and
// these touch no other bodies.

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
    const Mobility mobility = mobilityOf(*rigid);
    added.linear = std::sqrt(mobility.linear);
    added.angular.factorize([&](int r, int c) { return mobility.angular[r][c]; }, 3);
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
  if (!rows_.addEndsTo(newton_, root_)) return false;
  if (!addJointsTo() || !newton_.solve() || !withinBounds()) {
    joints_.release();
    return false;
  }
  takeImpulses();
  return true;
}

bool ReducedContactSolver::addJointsTo() {
  for (std::size_t i = 0; joints_.any() && i < island_.size(); ++i) {
    const int unknown = axes_ + 6 * static_cast<int>(i) + 3;
    if (!joints_.addTo(newton_, island_[i].solver_body, unknown)) return false;
  }
  return true;
}

// True when no bound is exceeded. A bound that acts couples the contacts of its body, which only
// the sweeps can handle.
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
  joints_.takeFrom(newton_);
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
