#include "loop/dynamics/articulated_body.hpp"

#include "bullet_twin.hpp"
#include "files/shipped_models.hpp"
#include "random_tree.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <array>
#include <cmath>
#include <string>

namespace wholehand::test {
namespace {

/// Residual of M θ̈ + h = τ, relative to the terms that add up to τ.
double residual(const ArticulatedBody& body, const Eigen::VectorXd& acceleration,
                const JointEffort& torque) {
  const Eigen::MatrixXd m = body.inertia();
  const Eigen::VectorXd sum = m * acceleration + body.bias().vec() - torque.vec();
  const Eigen::VectorXd terms = m.cwiseAbs() * acceleration.cwiseAbs() +
                                body.bias().vec().cwiseAbs() + torque.vec().cwiseAbs();
  return sum.cwiseAbs().cwiseQuotient(terms).maxCoeff();
}

/// Prints "figure: <name> = <value>"; the value is relative and has no unit.
void relativeFigure(const std::string& name, double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  std::printf("figure: %s = %s\n", name.c_str(), text.data());
  ::testing::Test::RecordProperty(name, text.data());
}

/// Condition number of a matrix: a random tree may be so ill-conditioned that inverting loses
/// digits.
double condition(const Eigen::MatrixXd& m) {
  const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(m).eigenvalues();
  return values[values.size() - 1] / values[0];
}

/// A random tree in our implementation and in Bullet's, in the same random state.
struct Twins {
  Twins(const HandModel& hand, Rng& rng) : body(hand), bullet(hand), s(randomState(rng, hand)) {
    bullet.setState(s.theta, s.theta_dot);
  }
  ArticulatedBody body;
  BulletTwin bullet;
  JointState s;
};

TEST(ArticulatedBody, RandomTrees_ForwardDynamicsAndBiasEqualThoseOfBullet) {
  forRandomTrees(7, 300, [](const HandModel& hand, Rng& rng) {
    Twins twins(hand, rng);
    auto& [body, bullet, s] = twins;
    const Eigen::Vector3d gravity = randomVector(rng, 10.0);
    ASSERT_TRUE(body.update(s.theta, s.theta_dot, gravity));
    // Bullet's articulated-body algorithm shares no code and no method with ours.
    EXPECT_LE(residual(body, bullet.acceleration(s.torque, gravity), s.torque), tolerance(1e-10));
    // Under τ = h Bullet must find no acceleration, relative to the acceleration without torque.
    const double unheld =
        bullet.acceleration(JointEffort(hand.joint_count), gravity).cwiseAbs().maxCoeff();
    EXPECT_LE(bullet.acceleration(body.bias(), gravity).cwiseAbs().maxCoeff(),
              tolerance(1e-9) * unheld);
  });
}

TEST(ArticulatedBody, RandomTrees_InertiaTimesBulletsInverseIsIdentity) {
  forRandomTrees(9, 60, [](const HandModel& hand, Rng& rng) {
    Twins twins(hand, rng);
    auto& [body, bullet, s] = twins;
    ASSERT_TRUE(body.update(s.theta, s.theta_dot, Eigen::Vector3d::Zero()));
    for (int j = 0; j < hand.joint_count; ++j) {
      Eigen::VectorXd unit = body.inertia() * bullet.inverseInertiaColumn(j);
      unit[j] -= 1.0;
      EXPECT_LE(unit.cwiseAbs().maxCoeff(), tolerance(1e-9)) << "joint " << j;
    }
  });
}

TEST(ArticulatedBody, RandomTrees_LinkPositionsEqualThoseOfBullet) {
  forRandomTrees(10, 60, [](const HandModel& hand, Rng& rng) {
    Twins twins(hand, rng);
    auto& [body, bullet, s] = twins;
    body.updateKinematics(s.theta);
    for (int i = 0; i < static_cast<int>(hand.links.size()); ++i) {
      EXPECT_LE((body.linkPose(i) * hand.links[i].com_m - bullet.linkCom(i)).norm(),
                tolerance(1e-12));
    }
  });
}

TEST(ArticulatedBody, KinematicsTakenFromAnotherBody_GiveTheSameBits) {
  forRandomTrees(10, 100, [](const HandModel& hand, Rng& rng) {
    ArticulatedBody own(hand), placed(hand), taken(hand);
    const Eigen::Vector3d gravity = randomVector(rng, 10.0);
    // Updates at another state first, so that anything left of it would show.
    const JointState before = randomState(rng, hand), s = randomState(rng, hand);
    ASSERT_TRUE(taken.update(before.theta, before.theta_dot, gravity));
    ASSERT_TRUE(own.update(s.theta, s.theta_dot, gravity));
    placed.updateKinematics(s.theta);
    ASSERT_TRUE(taken.updateFrom(placed, s.theta_dot, gravity));
    EXPECT_EQ(taken.inertia(), own.inertia());
    EXPECT_EQ(taken.bias().vec(), own.bias().vec());
    EXPECT_EQ(taken.reducedInertiaInverse(), own.reducedInertiaInverse());
    for (int l = 0; l < static_cast<int>(hand.links.size()); ++l) {
      EXPECT_EQ(taken.linkPose(l).rotation, own.linkPose(l).rotation);
      EXPECT_EQ(taken.linkPose(l).translation_m, own.linkPose(l).translation_m);
    }
  });
}

TEST(ArticulatedBody, DistributedTorque_GivesExactReducedForceAndKeepsSynergy) {
  forRandomTrees(12, 100, [](const HandModel& hand, Rng& rng) {
    Twins twins(hand, rng);
    auto& [body, bullet, s] = twins;
    const Eigen::Vector3d gravity(0.0, 0.0, -9.81);
    ASSERT_TRUE(body.update(s.theta, s.theta_dot, gravity));
    AxisEffort f_s(hand.axis_count);
    for (int a = 0; a < hand.axis_count; ++a) f_s[a] = uniform(rng, -3.0, 3.0);
    JointEffort torque;
    body.distribute(f_s, torque);

    const Eigen::MatrixXd g = hand.synergy;
    const Eigen::VectorXd driving = torque.vec() - body.bias().vec();
    // Gᵀ (τ − h) = f_s: the rendered effort is the virtual-work force.
    const double reduced_rounding = 1e-15 * condition(body.reducedInertia());
    // A drawn f_s may be nearly zero; the rounding is that of τ, which also balances h.
    const double torque_rounding =
        1e-14 * (g.cwiseAbs().transpose() * torque.vec().cwiseAbs()).norm();
    EXPECT_LE((g.transpose() * driving - f_s.vec()).norm(),
              tolerance((1e-10 + reduced_rounding) * f_s.vec().norm() + torque_rounding));
    // M⁻¹ (τ − h) lies in range(G): the coupled joints need no constraint. Bullet computes the
    // acceleration.
    const Eigen::VectorXd acceleration = bullet.acceleration(torque, gravity);
    const Eigen::VectorXd reduced = g.colPivHouseholderQr().solve(acceleration);
    // τ also balances h, so the rounding is a share of the acceleration that h alone would cause.
    const double unheld =
        bullet.acceleration(JointEffort(hand.joint_count), gravity).norm() + acceleration.norm();
    EXPECT_LE((acceleration - g * reduced).norm(), tolerance(1e-10) * unheld);
    // The same with our own M, to rounding.
    const Eigen::MatrixXd m = body.inertia();
    const Eigen::VectorXd own = m.llt().solve(driving);
    const Eigen::VectorXd own_reduced = g.colPivHouseholderQr().solve(own);
    EXPECT_LE((own - g * own_reduced).norm(), tolerance(1e-10) * unheld);
  });
}

// ---- the shipped hands

struct DeviceAndHand {
  const char* device;
  const char* hand;
};

class ShippedHand : public testing::TestWithParam<DeviceAndHand> {
 protected:
  /// A posture and rates as in a tick: on the synergy, within some centimetres.
  static JointState posture(Rng& rng, const HandModel& hand) {
    JointState s{hand.theta0, JointVelocity(hand.joint_count), JointEffort(hand.joint_count)};
    for (int a = 0; a < hand.axis_count; ++a) {
      s.theta.vec() += hand.synergy.col(a) * (hand.reference[a] + uniform(rng, -0.2, 0.2));
      s.theta_dot.vec() += hand.synergy.col(a) * uniform(rng, -5.0, 5.0);
    }
    return s;
  }
};

TEST_P(ShippedHand, ForwardDynamics_EqualBulletsTo1em9) {
  const HandModel hand = handNamed(GetParam().hand, GetParam().device);
  ArticulatedBody body(hand);
  BulletTwin bullet(hand);
  auto rng = seededRandom<Rng>(41);
  double worst = 0.0, worst_bias = 0.0;
  for (int k = 0; k < cases(50); ++k) {
    JointState s = posture(rng, hand);
    for (int j = 0; j < hand.joint_count; ++j) s.torque[j] = uniform(rng, -0.5, 0.5);
    const Eigen::Vector3d gravity(0.0, 0.0, -9.81);
    ASSERT_TRUE(body.update(s.theta, s.theta_dot, gravity));
    bullet.setState(s.theta, s.theta_dot);
    const Eigen::VectorXd theirs = bullet.acceleration(s.torque, gravity);
    const double whole = residual(body, theirs, s.torque);
    // Under τ = h Bullet must find no acceleration, relative to the acceleration without torque.
    const Eigen::VectorXd unheld = bullet.acceleration(JointEffort(hand.joint_count), gravity);
    const double bias = bullet.acceleration(body.bias(), gravity).cwiseAbs().maxCoeff() /
                        unheld.cwiseAbs().maxCoeff();
    EXPECT_LE(whole, tolerance(1e-9));
    EXPECT_LE(bias, tolerance(1e-9));
    worst = std::max(worst, whole);
    worst_bias = std::max(worst_bias, bias);
  }
  const std::string of = std::string(GetParam().hand) + " on " + GetParam().device;
  relativeFigure("M and h against Bullet, largest relative difference, " + of, worst);
  relativeFigure("h alone against Bullet, largest relative difference, " + of, worst_bias);
}

TEST_P(ShippedHand, CoupledAcceleration_StaysOnTheSynergy) {
  const HandModel hand = handNamed(GetParam().hand, GetParam().device);
  ArticulatedBody body(hand);
  BulletTwin bullet(hand);
  auto rng = seededRandom<Rng>(42);
  const Eigen::MatrixXd g = hand.synergy;
  for (int k = 0; k < cases(50); ++k) {
    const JointState s = posture(rng, hand);
    ASSERT_TRUE(body.update(s.theta, s.theta_dot, {0.0, 0.0, -9.81}));
    AxisEffort f_s(hand.axis_count);
    for (int a = 0; a < hand.axis_count; ++a) {
      f_s[a] = body.reducedInertia()(a, a) * uniform(rng, -50.0, 50.0);
    }
    JointEffort torque;
    body.distribute(f_s, torque);
    const Eigen::VectorXd driving = torque.vec() - body.bias().vec();
    EXPECT_LE((g.transpose() * driving - f_s.vec()).cwiseAbs().maxCoeff(),
              tolerance(1e-10) * f_s.vec().cwiseAbs().maxCoeff());
    bullet.setState(s.theta, s.theta_dot);
    const Eigen::VectorXd a = bullet.acceleration(torque, {0.0, 0.0, -9.81});
    const Eigen::VectorXd reduced = body.reducedInertiaInverse() * f_s.vec();
    EXPECT_LE((a - g * reduced).cwiseAbs().maxCoeff(), tolerance(1e-8) * a.cwiseAbs().maxCoeff());
  }
}

INSTANTIATE_TEST_SUITE_P(Config, ShippedHand,
                         testing::Values(DeviceAndHand{"lambda-pride", "adult-median-right"},
                                         DeviceAndHand{"lambda-pride", "adult-median-left"},
                                         DeviceAndHand{"wrist-9axis", "adult-median-right"},
                                         DeviceAndHand{"desktop-3axis", "woman-p05-right"}));

}  // namespace
}  // namespace wholehand::test
