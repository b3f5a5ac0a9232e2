#include "loop/physics/bullet/joint_rows.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

constexpr double kRounding = 1e-12;  // smaller relative changes of an impulse are rounding

}  // namespace

void projectOnChain(const SolverJoint& on, btVector3& linear, btVector3& angular) noexcept {
  angular = toBt(on.chain->project(on.link, toEigen(linear), toEigen(angular)));
  linear.setZero();
}

double rateAlongChain(const SolverJoint& on, const btVector3& row) noexcept {
  return toEigen(row).dot(on.chain->rate());
}

void JointRows::add(btRigidBody& rigid, BodyJoint& joint) {
  rigid.setUserPointer(&on_.emplace_back(SolverJoint{&joint, nullptr, -1, &rigid}));
  rows_.push_back({&rigid, &joint});
}

void JointRows::add(const std::vector<btRigidBody*>& links, JointChain& chain) {
  for (std::size_t i = 0; i < links.size(); ++i) {
    links[i]->setUserPointer(
        &on_.emplace_back(SolverJoint{nullptr, &chain, static_cast<int>(i), links.front()}));
  }
  chains_.add(*links.front(), chain);
}

void JointRows::begin(std::vector<bool>& touched) noexcept {
  for (Row& row : rows_) {
    row.body = row.rigid->getCompanionId();
    row.first = -1;
    row.acts = row.solved = false;
    row.first_cone = -1;
    const double most = row.joint->mostFriction();
    row.friction = std::clamp(row.friction, -most, most);
    if (row.body >= 0) touched[row.body] = true;
  }
  chains_.begin(touched);
}

// The joint has one unknown, q̇: friction acts first, as far as it stops the joint; then an end
// adds the missing impulse.
double JointRows::solve(Bodies& bodies) noexcept {
  double largest = 0.0;
  for (Row& row : rows_) {
    if (row.body < 0 || row.first >= 0 || row.solved) continue;
    const BodyJoint& joint = *row.joint;
    double& change = bodies[row.body].m_deltaAngularVelocity[0];
    const double before = row.friction + row.end;
    const double free = joint.rate() + change - (row.acts ? joint.yield() * before : 0.0);
    const double most = joint.mostFriction();
    row.friction = std::clamp(-free / joint.yield(), -most, most);
    const double rubbed = free + joint.yield() * row.friction;
    const double rate = std::clamp(rubbed, joint.leastRate(), joint.mostRate());
    row.end = (rate - rubbed) / joint.yield();
    row.acts = true;
    change = rate - joint.rate();
    const double changed = std::abs(row.friction + row.end - before);
    if (changed > kRounding * std::abs(before)) largest = std::max(largest, changed);
  }
  return chains_.any() ? std::max(largest, chains_.solve(bodies)) : largest;
}

bool JointRows::addTo(ConeNewton& newton, int body, int unknown) noexcept {
  for (Row& row : rows_) {
    if (row.body != body) continue;
    const BodyJoint& joint = *row.joint;
    const double root = std::sqrt(joint.yield());
    row.first = newton.rowCount();
    const auto give = [&](ConeNewton::Row* to, double along, double goal, double start) {
      if (to == nullptr) return false;
      to->along[unknown] = along;
      to->goal = goal;
      to->start = start;
      return true;
    };
    const double most = joint.mostFriction();
    return give(newton.addBox(most > 0.0 ? most : 1e-300), root, -joint.rate(), row.friction) &&
           give(newton.add(1, 0.0, 0.0), root, joint.leastRate() - joint.rate(),
                std::max(0.0, row.end)) &&
           give(newton.add(1, 0.0, 0.0), -root, joint.rate() - joint.mostRate(),
                std::max(0.0, -row.end));
  }
  return chains_.addTo(newton, body, unknown);
}

void JointRows::takeFrom(const ConeNewton& newton) noexcept {
  chains_.takeFrom(newton);
  for (Row& row : rows_) {
    if (row.first < 0) continue;
    row.friction = newton.row(row.first).impulse;
    row.end = newton.row(row.first + 1).impulse - newton.row(row.first + 2).impulse;
  }
}

bool JointRows::addTo(IslandNewton& newton, int body, int slot) noexcept {
  for (Row& row : rows_) {
    if (row.body != body) continue;
    const BodyJoint& joint = *row.joint;
    row.first_cone = newton.contactCount();
    const auto give = [&](int which, double sign, double goal, double start) {
      IslandNewton::Contact* to = newton.add(slot, -1);
      if (to == nullptr) return false;
      to->of_joint = true;
      to->along_a[which][3] = sign * std::sqrt(joint.yield());
      to->goal[which] = goal;
      to->start[which] = start;
      if (which > 0) to->box = joint.mostFriction();
      return true;
    };
    return give(1, 1.0, -joint.rate(), row.friction) &&
           give(0, 1.0, joint.leastRate() - joint.rate(), std::max(0.0, row.end)) &&
           give(0, -1.0, joint.rate() - joint.mostRate(), std::max(0.0, -row.end));
  }
  return chains_.addTo(newton, body, slot);
}

void JointRows::takeFrom(const IslandNewton& newton, int body) noexcept {
  chains_.takeFrom(newton, body);
  for (Row& row : rows_) {
    if (row.body != body) continue;
    row.solved = true;
    row.friction = newton.contact(row.first_cone).impulse[1];
    row.end = newton.contact(row.first_cone + 1).impulse[0] -
              newton.contact(row.first_cone + 2).impulse[0];
  }
}

bool JointRows::endBears(const SolverJoint& on, const btVector3& along) const noexcept {
  if (on.chain != nullptr) return chains_.endBears(*on.chain, along);
  for (const Row& row : rows_) {
    if (row.joint == on.joint) return along.x() * row.end < 0.0;
  }
  return false;
}

void JointRows::release() noexcept {
  for (Row& row : rows_) row.first = -1;
  chains_.release();
}

}  // namespace wholehand::bullet
