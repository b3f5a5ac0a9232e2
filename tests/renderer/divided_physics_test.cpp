// Physics at a divisor of the rate, in the whole renderer.
#include "support/rig_tools.hpp"

#include <Eigen/LU>

namespace wholehand::test {
namespace {

constexpr int kDivisor = 4;
constexpr double kRate_hz = 4000.0;

std::unique_ptr<Rig> movingRig() {
  Models m = load(shippedFiles());
  m.rendering.physics_divisor = kDivisor;
  RigOptions options;
  options.period_s = 1.0 / kRate_hz;
  const AxisPosition here = m.hand.reference;
  AxisPosition there = here;
  there[m.device.axisIndex("x")] += 0.05;
  there[m.device.axisIndex("finger_flexion")] += 0.3;
  return buildScripted(m, moveAndHold(here, there, 2000), options);
}

bool equal(const auto& a, const auto& b) {
  for (int i = 0; i < a.size(); ++i) {
    if (a[i] != b[i]) return false;
  }
  return true;
}

TEST(PhysicsAtADivisor, AvatarIsHeldBetweenTheSteps_TheCouplingIsNot) {
  const auto rig = movingRig();
  ASSERT_TRUE(rig->renderer->arm());
  std::unique_ptr<TickRecord> before;
  int steps = 0, felt = 0;
  runTicks(*rig->renderer, 2000, [&](const TickRecord& r) {
    if (before != nullptr && r.tick > 100) {
      const bool moved = !equal(r.q_s, before->q_s);
      EXPECT_EQ(moved, r.tick % kDivisor == 1) << "tick " << r.tick;
      steps += moved ? 1 : 0;
      felt += equal(r.coupling, before->coupling) ? 0 : 1;
    }
    before = std::make_unique<TickRecord>(r);
  });
  EXPECT_EQ(steps, 475);  // in ticks 101, 105 .. 1997
  EXPECT_EQ(felt, 1899) << "the effort of every tick is of its own position";
}

/// Eq. (4) over a step of dT, with the drive of the tick that steps: M_r Δq̇_s = dT f_s.
TEST(PhysicsAtADivisor, FreeHand_FollowsTheDriveOfTheTickThatSteps) {
  const auto rig = movingRig();
  ASSERT_TRUE(rig->renderer->arm());
  const double step_s = kDivisor / kRate_hz;
  TickRecord at;
  double worst = 0.0, fastest = 0.0;
  runTicks(*rig->renderer, 2000, [&](const TickRecord& r) {
    if (r.tick > 0 && r.tick % kDivisor == 1) {
      ArticulatedBody hand(rig->models.hand, rig->gains.armature);
      ASSERT_TRUE(hand.update(at.theta, JointVelocity(at.theta.size()), Eigen::Vector3d::Zero()));
      for (int i = 0; i < r.q_s.size(); ++i) {
        double acceleration = 0.0;
        for (int k = 0; k < r.q_s.size(); ++k) {
          acceleration += hand.reducedInertiaInverse()(i, k) * at.f_s[k];
        }
        worst = std::max(worst, std::abs(r.qd_s[i] - at.qd_s[i] - step_s * acceleration));
        worst = std::max(worst, std::abs(r.q_s[i] - at.q_s[i] - step_s * r.qd_s[i]));
        fastest = std::max(fastest, std::abs(r.qd_s[i]));
      }
    }
    if (r.tick % kDivisor == 0) at = r;
  });
  EXPECT_GT(fastest, 0.1);
  EXPECT_LE(worst, 1e-9);
}

TEST(PhysicsAtADivisor, ArmedAgain_StepsInItsFirstTickAgain) {
  const auto rig = movingRig();
  ASSERT_TRUE(rig->renderer->arm());
  const auto first = runTicks(*rig->renderer, 402);  // leaves between two steps
  rig->renderer->requestStop();
  runTicks(*rig->renderer, 2000, {}, 402);
  ASSERT_TRUE(rig->renderer->finished());
  ASSERT_TRUE(rig->renderer->arm());
  const auto again = runTicks(*rig->renderer, 402);
  EXPECT_TRUE(equal(first->q_s, again->q_s));
  EXPECT_TRUE(equal(first->sent, again->sent));
}

}  // namespace
}  // namespace wholehand::test
