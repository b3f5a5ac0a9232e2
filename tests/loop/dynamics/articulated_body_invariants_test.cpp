#include "loop/dynamics/articulated_body.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "random_tree.hpp"

#include <Eigen/Cholesky>

#include <array>
#include <cmath>
#include <numbers>

namespace wholehand::test {
namespace {

TEST(ArticulatedBody, RandomTrees_InertiasAreSymmetricAndPositiveDefinite) {
  forRandomTrees(11, 100, [](const HandModel& hand, Rng& rng) {
    ArticulatedBody body(hand);
    const JointState s = randomState(rng, hand);
    ASSERT_TRUE(body.update(s.theta, s.theta_dot, Eigen::Vector3d::Zero()));
    const Eigen::MatrixXd m = body.inertia();
    const Eigen::MatrixXd reduced = body.reducedInertia();
    EXPECT_EQ((m - m.transpose()).cwiseAbs().maxCoeff(), 0.0);
    EXPECT_EQ((reduced - reduced.transpose()).cwiseAbs().maxCoeff(), 0.0);
    EXPECT_EQ(m.llt().info(), Eigen::Success);
    // M_r, h_r and the inverse by their definitions, with dense matrices.
    const Eigen::MatrixXd g = hand.synergy;
    EXPECT_LE((reduced - g.transpose() * m * g).norm(), tolerance(1e-12) * reduced.norm());
    EXPECT_LE((body.reducedBias().vec() - g.transpose() * body.bias().vec()).norm(),
              tolerance(1e-12) * (1.0 + body.bias().vec().norm()));
    // Inverting an ill-conditioned tree loses as many digits as its condition number has.
    const Eigen::MatrixXd inverse = body.reducedInertiaInverse();
    EXPECT_LE(
        (inverse * reduced - Eigen::MatrixXd::Identity(hand.axis_count, hand.axis_count)).norm(),
        tolerance(1e-9 + 1e-14 * inverse.norm() * reduced.norm()));
  });
}

TEST(ArticulatedBody, ReducedRows_AreDerivativesOfForwardKinematics) {
  forRandomTrees(13, 60, [](const HandModel& hand, Rng& rng) {
    ArticulatedBody body(hand);
    const JointState s = randomState(rng, hand);
    const int link = static_cast<int>(uniform(rng, 0.0, static_cast<double>(hand.links.size())));
    const Eigen::Vector3d local = randomVector(rng, 0.05);
    const Eigen::Vector3d direction = randomVector(rng, 1.0);
    body.updateKinematics(s.theta);
    const Pose pose = body.linkPose(link);
    std::array<double, kMaxAxes> point_row{}, angular_row{};
    body.reducedPointRow(link, pose * local, direction, point_row.data());
    body.reducedAngularRow(link, direction, angular_row.data());

    // The rows of a contact are those of its directions, to the bit.
    const std::array<Eigen::Vector3d, 3> directions{direction, randomVector(rng, 1.0),
                                                    randomVector(rng, 1.0)};
    std::array<std::array<double, kMaxAxes>, 4> rows{};
    body.reducedContactRows(link, pose * local, directions,
                            {rows[0].data(), rows[1].data(), rows[2].data(), rows[3].data()});
    EXPECT_EQ(rows[0], point_row);
    EXPECT_EQ(rows[3], angular_row);
    for (int k = 1; k < 3; ++k) {
      std::array<double, kMaxAxes> one{};
      body.reducedPointRow(link, pose * local, directions[k], one.data());
      EXPECT_EQ(rows[k], one);
    }

    constexpr double kStep = 1e-6;  // central difference: error about kStep² and 1e-16 / kStep
    for (int a = 0; a < hand.axis_count; ++a) {
      std::array<Pose, 2> moved;
      for (int side = 0; side < 2; ++side) {
        JointPosition theta = s.theta;
        theta.vec() += (side == 0 ? -kStep : kStep) * hand.synergy.col(a);
        body.updateKinematics(theta);
        moved[side] = body.linkPose(link);
      }
      const Eigen::Vector3d velocity = (moved[1] * local - moved[0] * local) / (2.0 * kStep);
      EXPECT_NEAR(point_row[a], direction.dot(velocity), tolerance(1e-8));
      const Eigen::Matrix3d spin =
          (moved[1].rotation - moved[0].rotation) * pose.rotation.transpose() / (2.0 * kStep);
      EXPECT_NEAR(angular_row[a],
                  direction.dot(Eigen::Vector3d(spin(2, 1), spin(0, 2), spin(1, 0))),
                  tolerance(1e-8));
    }
  });
}

double kinetic(const ArticulatedBody& body, const JointVelocity& v) {
  return 0.5 * v.vec().dot(body.inertia() * v.vec());
}

double potential(const ArticulatedBody& body, const Eigen::Vector3d& gravity) {
  double out = 0.0;
  for (std::size_t i = 0; i < body.hand().links.size(); ++i) {
    const HandLink& link = body.hand().links[i];
    out -= link.mass_kg * gravity.dot(body.linkPose(static_cast<int>(i)) * link.com_m);
  }
  return out;
}

/// θ̈ by the joint-space equation of motion.
Eigen::VectorXd accelerate(ArticulatedBody& body, const JointState& s,
                           const Eigen::Vector3d& gravity) {
  (void)body.update(s.theta, s.theta_dot, gravity);
  const Eigen::MatrixXd m = body.inertia();
  return m.llt().solve(s.torque.vec() - body.bias().vec());
}

/// Classic fourth-order Runge-Kutta step of the joint-space dynamics under constant torque.
void integrate(ArticulatedBody& body, JointState& s, const Eigen::Vector3d& gravity, double dt_s) {
  const auto at = [&](const Eigen::VectorXd& dq, const Eigen::VectorXd& dv) {
    JointState moved = s;
    moved.theta.vec() += dq;
    moved.theta_dot.vec() += dv;
    return moved;
  };
  const Eigen::VectorXd v1 = s.theta_dot.vec();
  const Eigen::VectorXd a1 = accelerate(body, s, gravity);
  const Eigen::VectorXd v2 = v1 + 0.5 * dt_s * a1;
  const Eigen::VectorXd a2 = accelerate(body, at(0.5 * dt_s * v1, 0.5 * dt_s * a1), gravity);
  const Eigen::VectorXd v3 = v1 + 0.5 * dt_s * a2;
  const Eigen::VectorXd a3 = accelerate(body, at(0.5 * dt_s * v2, 0.5 * dt_s * a2), gravity);
  const Eigen::VectorXd v4 = v1 + dt_s * a3;
  const Eigen::VectorXd a4 = accelerate(body, at(dt_s * v3, dt_s * a3), gravity);
  s.theta.vec() += dt_s / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
  s.theta_dot.vec() += dt_s / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
}

TEST(ArticulatedBody, FreeSwing_KeepsItsEnergy) {
  Rng rng(21);
  const HandModel hand = randomTree(rng, 8, 3);
  ArticulatedBody body(hand);
  JointState s = randomState(rng, hand);
  s.torque = JointEffort(hand.joint_count);
  const Eigen::Vector3d gravity(0.0, 0.0, -9.81);
  ASSERT_TRUE(body.update(s.theta, s.theta_dot, gravity));
  const double kinetic_before = kinetic(body, s.theta_dot);
  const double before = kinetic_before + potential(body, gravity);
  double most_kinetic = 0.0;
  double least_kinetic = kinetic_before;
  for (int k = 0; k < 4000; ++k) {
    integrate(body, s, gravity, 5e-5);
    most_kinetic = std::max(most_kinetic, kinetic(body, s.theta_dot));
    least_kinetic = std::min(least_kinetic, kinetic(body, s.theta_dot));
  }
  ASSERT_TRUE(body.update(s.theta, s.theta_dot, gravity));
  const double after = kinetic(body, s.theta_dot) + potential(body, gravity);
  EXPECT_NEAR(after, before, tolerance(1e-6) * most_kinetic);
  EXPECT_GT(most_kinetic - least_kinetic, 0.05 * kinetic_before);  // the tree did swing
}

TEST(ArticulatedBody, DrivenMotion_EnergyGrowsByThePowerOfTheTorques) {
  forRandomTrees(22, 40, [](const HandModel& hand, Rng& rng) {
    ArticulatedBody body(hand);
    const JointState s = randomState(rng, hand);
    const Eigen::Vector3d gravity(1.0, -2.0, -9.0);
    constexpr double kStep_s = 1e-5;
    std::array<double, 2> energy{};
    for (int side = 0; side < 2; ++side) {
      JointState moved = s;
      integrate(body, moved, gravity, side == 0 ? -kStep_s : kStep_s);
      ASSERT_TRUE(body.update(moved.theta, moved.theta_dot, gravity));
      energy[side] = kinetic(body, moved.theta_dot) + potential(body, gravity);
    }
    const double power_w = s.torque.vec().dot(s.theta_dot.vec());
    EXPECT_NEAR((energy[1] - energy[0]) / (2.0 * kStep_s), power_w,
                tolerance(1e-4) * (1.0 + std::abs(power_w)));
  });
}

/// A rod of length l hinged at its end, compared with the textbook's closed form.
TEST(ArticulatedBody, HingedRod_HasTextbookInertiaAndWeight) {
  HandModel hand;
  hand.joint_count = hand.axis_count = 1;
  HandLink rod;
  rod.type = JointType::kRevolute;
  rod.axis = Eigen::Vector3d::UnitY();
  rod.joint = 0;
  rod.mass_kg = 0.2;
  rod.com_m = {0.15, 0.0, 0.0};
  rod.inertia_kg_m2 = Eigen::Vector3d(0.0, 1.0, 1.0).asDiagonal() * (0.2 * 0.3 * 0.3 / 12.0);
  hand.links.push_back(rod);
  hand.synergy = JointAxisMatrix::Ones(1, 1);
  ArticulatedBody body(hand);
  JointPosition theta(1, std::numbers::pi / 6.0);
  ASSERT_TRUE(body.update(theta, JointVelocity(1, 2.0), {0.0, 0.0, -9.81}));
  EXPECT_NEAR(body.inertia()(0, 0), 0.2 * 0.3 * 0.3 / 3.0, tolerance(1e-15));  // m l² / 3
  // A rotation about +y lowers +x, so holding the rod up needs −m g (l/2) cos θ.
  EXPECT_NEAR(body.bias()[0], -0.2 * 9.81 * 0.15 * std::cos(std::numbers::pi / 6.0),
              tolerance(1e-14));
}

TEST(ArticulatedBody, AxisThatMovesNothing_IsReportedAndInverseIsZero) {
  Rng rng(5);
  HandModel hand = randomTree(rng, 6, 2);
  hand.synergy.col(1).setZero();
  ArticulatedBody body(hand);
  const JointState s = randomState(rng, hand);
  EXPECT_FALSE(body.update(s.theta, s.theta_dot, Eigen::Vector3d::Zero()));
  EXPECT_EQ(body.reducedInertiaInverse().cwiseAbs().maxCoeff(), 0.0);
}

TEST(ArticulatedBody, NonFinitePosition_IsReported) {
  Rng rng(6);
  const HandModel hand = randomTree(rng, 12, 2);
  ArticulatedBody body(hand);
  JointState s = randomState(rng, hand);
  s.theta.vec().setConstant(std::nan(""));
  EXPECT_FALSE(body.update(s.theta, s.theta_dot, Eigen::Vector3d::Zero()));
}

TEST(ArticulatedBody, TickFunctions_DoNotAllocate) {
  Rng rng(31);
  const HandModel hand = randomTree(rng, 30, 9);
  ArticulatedBody body(hand);
  const JointState s = randomState(rng, hand);
  const AxisEffort f_s(hand.axis_count, 1.0);
  JointEffort torque;
  std::array<double, kMaxAxes> row{};
  const AllocationScope scope;
  const bool ok = body.update(s.theta, s.theta_dot, {0.0, 0.0, -9.81});
  body.distribute(f_s, torque);
  body.reducedPointRow(3, {0.1, 0.2, 0.3}, {0.0, 0.0, 1.0}, row.data());
  body.reducedAngularRow(3, {0.0, 0.0, 1.0}, row.data());
  EXPECT_EQ(scope.allocations(), 0U);
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace wholehand::test
