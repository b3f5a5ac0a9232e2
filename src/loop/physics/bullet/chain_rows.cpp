#include "loop/physics/bullet/chain_rows.hpp"

#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/row_arithmetic.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

constexpr double kUnchanged = 1e-12;  // smaller relative changes of an impulse are rounding
// Sweeps over the coordinates of a tree. The inertia couples them, so one is not enough.
constexpr int kMostTreeSweeps = 60;

InertiaRoot<3> rateRoot(const JointChain& chain) noexcept {
  InertiaRoot<3> root;
  root.factorize([&](int r, int c) { return chain.mobility()(r, c); }, 3);
  return root;
}

/// Row of a coordinate's rate in the velocities in which the inertia is 1.
std::array<double, 3> rateRow(const InertiaRoot<3>& root, int coordinate, double sign) noexcept {
  std::array<double, 3> unit{}, row{};
  unit[coordinate] = sign;
  root.transpose(unit.data(), row.data());
  return row;
}

}  // namespace

void ChainRows::add(btRigidBody& lead, JointChain& chain) {
  trees_.push_back({&lead, &chain});
}

void ChainRows::begin(std::vector<bool>& touched) noexcept {
  for (Tree& tree : trees_) {
    tree.body = tree.lead->getCompanionId();
    tree.first = tree.first_cone = -1;
    tree.acts = tree.solved = false;
    for (int k = 0; k < tree.chain->coordinates(); ++k) {
      const double most = tree.chain->mostFriction()[k];
      tree.of[k].friction = std::clamp(tree.of[k].friction, -most, most);
    }
    if (tree.body >= 0) touched[tree.body] = true;
  }
}

// Friction of a coordinate acts first, as far as it stops it; then an end adds the missing impulse.
double ChainRows::sweep(Tree& tree, btVector3& change) noexcept {
  const JointChain& chain = *tree.chain;
  double largest = 0.0;
  for (int k = 0; k < chain.coordinates(); ++k) {
    Coordinate& of = tree.of[k];
    const double before = tree.acts ? of.friction + of.end : 0.0;
    const double yield = chain.mobility()(k, k), most = chain.mostFriction()[k];
    const double free = chain.rate()[k] + change[k] - yield * before;
    of.friction = std::clamp(-free / yield, -most, most);
    const double rubbed = free + yield * of.friction;
    const double rate = std::clamp(rubbed, chain.leastRate()[k], chain.mostRate()[k]);
    of.end = (rate - rubbed) / yield;
    const double impulse = of.friction + of.end - before;
    change += impulse * toBt(Eigen::Vector3d(chain.mobility().col(k)));
    if (std::abs(impulse) > kUnchanged * std::abs(before)) {
      largest = std::max(largest, std::abs(impulse));
    }
  }
  tree.acts = true;
  return largest;
}

double ChainRows::solve(Bodies& bodies) noexcept {
  double largest = 0.0;
  for (Tree& tree : trees_) {
    if (tree.body < 0 || tree.first >= 0 || tree.solved) continue;
    btVector3& change = bodies[tree.body].m_deltaAngularVelocity;
    double changed = sweep(tree, change);
    largest = std::max(largest, changed);
    for (int i = 1; i < kMostTreeSweeps && changed > 0.0; ++i) changed = sweep(tree, change);
  }
  return largest;
}

bool ChainRows::addTo(ConeNewton& newton, int body, int unknown) noexcept {
  for (Tree& tree : trees_) {
    if (tree.body != body) continue;
    const JointChain& chain = *tree.chain;
    const InertiaRoot<3> root = rateRoot(chain);
    tree.first = newton.rowCount();
    for (int k = 0; k < chain.coordinates(); ++k) {
      const auto give = [&](ConeNewton::Row* to, double sign, double goal, double start) {
        if (to == nullptr) return false;
        const std::array<double, 3> row = rateRow(root, k, sign);
        std::copy(row.begin(), row.end(), to->along.begin() + unknown);
        to->goal = goal;
        to->start = start;
        return true;
      };
      const Coordinate& of = tree.of[k];
      const double most = chain.mostFriction()[k], rate = chain.rate()[k];
      if (!give(newton.addBox(most > 0.0 ? most : 1e-300), 1.0, -rate, of.friction) ||
          !give(newton.add(1, 0.0, 0.0), 1.0, chain.leastRate()[k] - rate, std::max(0.0, of.end)) ||
          !give(newton.add(1, 0.0, 0.0), -1.0, rate - chain.mostRate()[k],
                std::max(0.0, -of.end))) {
        return false;
      }
    }
  }
  return true;
}

void ChainRows::takeFrom(const ConeNewton& newton) noexcept {
  for (Tree& tree : trees_) {
    if (tree.first < 0) continue;
    for (int k = 0; k < tree.chain->coordinates(); ++k) {
      const int row = tree.first + 3 * k;
      tree.of[k].friction = newton.row(row).impulse;
      tree.of[k].end = newton.row(row + 1).impulse - newton.row(row + 2).impulse;
    }
  }
}

bool ChainRows::addTo(IslandNewton& newton, int body, int slot) noexcept {
  for (Tree& tree : trees_) {
    if (tree.body != body) continue;
    const JointChain& chain = *tree.chain;
    const InertiaRoot<3> root = rateRoot(chain);
    tree.first_cone = newton.contactCount();
    for (int k = 0; k < chain.coordinates(); ++k) {
      const double most = chain.mostFriction()[k], rate = chain.rate()[k];
      const auto give = [&](int which, double sign, double goal, double start) {
        IslandNewton::Contact* to = newton.add(slot, -1);
        if (to == nullptr) return false;
        const std::array<double, 3> row = rateRow(root, k, sign);
        to->of_joint = true;
        std::copy(row.begin(), row.end(), to->along_a[which].begin() + 3);
        to->goal[which] = goal;
        to->start[which] = start;
        if (which > 0) to->box = most;
        return true;
      };
      const Coordinate& of = tree.of[k];
      if (!give(1, 1.0, -rate, of.friction) ||
          !give(0, 1.0, chain.leastRate()[k] - rate, std::max(0.0, of.end)) ||
          !give(0, -1.0, rate - chain.mostRate()[k], std::max(0.0, -of.end))) {
        return false;
      }
    }
  }
  return true;
}

void ChainRows::takeFrom(const IslandNewton& newton, int body) noexcept {
  for (Tree& tree : trees_) {
    if (tree.body != body) continue;
    tree.solved = true;
    for (int k = 0; k < tree.chain->coordinates(); ++k) {
      const int cone = tree.first_cone + 3 * k;
      tree.of[k].friction = newton.contact(cone).impulse[1];
      tree.of[k].end = newton.contact(cone + 1).impulse[0] - newton.contact(cone + 2).impulse[0];
    }
  }
}

bool ChainRows::endBears(const JointChain& chain, const btVector3& row) const noexcept {
  for (const Tree& tree : trees_) {
    if (tree.chain != &chain) continue;
    for (int k = 0; k < chain.coordinates(); ++k) {
      if (row[k] * tree.of[k].end < 0.0) return true;
    }
  }
  return false;
}

void ChainRows::release() noexcept {
  for (Tree& tree : trees_) tree.first = -1;
}

}  // namespace wholehand::bullet
