#pragma once

#include "loop/model/hand_model.hpp"
#include "support/seed.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace wholehand::test {

using Rng = std::mt19937;

inline double uniform(Rng& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}
inline Eigen::Vector3d randomVector(Rng& rng, double size) {
  return {uniform(rng, -size, size), uniform(rng, -size, size), uniform(rng, -size, size)};
}
inline Eigen::Matrix3d randomRotation(Rng& rng) {
  return Eigen::AngleAxisd(uniform(rng, -3.0, 3.0),
                           (randomVector(rng, 1.0) + Eigen::Vector3d(0.1, 0.2, 0.3)).normalized())
      .toRotationMatrix();
}

/// A random tree with every irregularity that the interface allows: any branching, skew axes,
/// general inertias, massless carriages, locked links of either kind (fixed, or without a joint),
/// joints numbered out of order.
inline HandModel randomTree(Rng& rng, int link_count, int axis_count) {
  HandModel hand;
  hand.axis_count = axis_count;
  for (int i = 0; i < link_count; ++i) {
    HandLink link;
    link.parent = i == 0 ? -1 : std::uniform_int_distribution<int>(std::max(-1, i - 5), i - 1)(rng);
    const double kind = uniform(rng, 0.0, 1.0);
    link.type = kind < 0.15   ? JointType::kFixed
                : kind < 0.45 ? JointType::kPrismatic
                              : JointType::kRevolute;
    link.axis = (randomVector(rng, 1.0) + Eigen::Vector3d(0.01, 0.02, 0.03)).normalized();
    link.parent_to_link = {randomRotation(rng), randomVector(rng, 0.1)};
    link.mass_kg = uniform(rng, 0.003, 0.3);
    link.com_m = randomVector(rng, 0.03);
    const Eigen::Matrix3d r = randomRotation(rng);
    const double size = link.mass_kg * 1e-4;
    link.inertia_kg_m2 =
        r *
        Eigen::Vector3d(uniform(rng, 1, 2), uniform(rng, 1, 2), uniform(rng, 1, 2)).asDiagonal() *
        r.transpose() * size;
    const bool locked = link.type == JointType::kFixed || uniform(rng, 0.0, 1.0) < 0.1;
    link.joint = locked ? -1 : hand.joint_count++;
    hand.links.push_back(link);
  }
  std::vector<int> order(hand.joint_count);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), rng);
  for (HandLink& link : hand.links) {
    if (link.joint >= 0) link.joint = order[link.joint];
  }
  hand.synergy = JointAxisMatrix::Zero(hand.joint_count, axis_count);
  for (int j = 0; j < hand.joint_count; ++j) {
    hand.synergy(j, j % axis_count) = uniform(rng, 0.2, 1.0);
    if (uniform(rng, 0.0, 1.0) < 0.3)
      hand.synergy(j, (j + 1) % axis_count) = uniform(rng, -1.0, 1.0);
  }
  hand.theta0 = JointPosition(hand.joint_count);
  return hand;
}

struct JointState {
  JointPosition theta;
  JointVelocity theta_dot;
  JointEffort torque;
};

inline JointState randomState(Rng& rng, const HandModel& hand) {
  JointState s{JointPosition(hand.joint_count), JointVelocity(hand.joint_count),
               JointEffort(hand.joint_count)};
  for (int j = 0; j < hand.joint_count; ++j) {
    s.theta[j] = uniform(rng, -1.5, 1.5);
    s.theta_dot[j] = uniform(rng, -8.0, 8.0);
    s.torque[j] = uniform(rng, -1.0, 1.0);
  }
  return s;
}

/// Calls `check(hand, rng)` for trees of 3 .. 30 links and 1 .. 9 axes that have a full-rank G.
template <class Check>
void forRandomTrees(unsigned stream, int count, Check check) {
  auto rng = seededRandom<Rng>(stream);
  int tried = 0;
  for (int k = 0; tried < cases(count); ++k) {
    ASSERT_LT(k, 10 * cases(count) + 100) << "hardly a tree has a full-rank G";
    const HandModel hand = randomTree(rng, 3 + k % 28, 1 + k % 9);
    if (hand.joint_count < std::max(hand.axis_count, 1)) continue;
    SCOPED_TRACE(testing::Message() << "tree " << k << ", " << hand.joint_count << " joints");
    check(hand, rng);
    ++tried;
  }
}

}  // namespace wholehand::test
