// First touch of a hand axis: closed forms, a moving hand, requested and unrequested axes.
#include "loop/physics/still_hand.hpp"
#include "support/tolerance.hpp"

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>

namespace wholehand::test {
namespace {

/// A palm with one finger of one bone, 8 cm long and 1 cm thick, that turns about z from angle 0.
HandModel oneFinger() {
  HandModel model;
  model.links.resize(2);
  model.links[0].name = "palm";
  model.links[1].name = "finger";
  model.links[1].parent = 0;
  model.links[1].type = JointType::kRevolute;
  model.links[1].axis = Eigen::Vector3d::UnitZ();
  model.links[1].joint = 0;
  model.capsules.push_back({"finger", HandPart::kIndex, 1, {0, 0, 0}, {0.08, 0, 0}, 0.005});
  model.joint_count = model.axis_count = 1;
  model.theta0 = JointPosition(1);
  model.synergy = JointAxisMatrix::Constant(1, 1, 0.5);  // half a radian per radian of the axis
  model.axis_lower = AxisPosition(1, -0.2);
  model.axis_upper = AxisPosition(1, 6.0);
  return model;
}

double touchOfOneFinger(const Eigen::Vector3d& ball_m, double radius_m) {
  const HandModel model = oneFinger();
  SceneModel scene = sceneOf(ballShape(radius_m));
  scene.bodies[0].com_m.setZero();
  AxisClosure closure(model, scene);
  const std::array<Pose, 2> links{};
  BodyState state;
  state.position_m = Vec3::from(ball_m);
  AxisPosition touch;
  // The axis may stand anywhere; its kinematic closure does not depend on that.
  for (int k = 0; k < 50; ++k) {
    closure.update(links.data(), JointPosition(1, 0.35), AxisPosition(1, 0.7), 0, &state, touch);
  }
  return touch[0];
}

TEST(FirstTouchOfOneFinger, WithABall_MatchesTheClosedForm) {
  const auto at = [](double distance_m, double angle_rad) {
    return Eigen::Vector3d(distance_m * std::cos(angle_rad), distance_m * std::sin(angle_rad), 0.0);
  };
  // Beside the bone: the touch is at the angle under which the joint sees the sum of the radii.
  const double beside = 1.5 - std::asin((0.02 + 0.005) / 0.06);
  EXPECT_NEAR(touchOfOneFinger(at(0.06, 1.5), 0.02), 2.0 * beside, tolerance(1e-6));
  // Beyond the tip: the triangle of joint, tip and ball has the sides 0.08, 0.1 and 0.025.
  const double tip = std::acos((0.08 * 0.08 + 0.1 * 0.1 - 0.025 * 0.025) / (2.0 * 0.08 * 0.1));
  EXPECT_NEAR(touchOfOneFinger(at(0.1, 1.5), 0.02), 2.0 * (1.5 - tip), tolerance(1e-6));
  // At 1 µm beyond the reach of the tip there is no touch; at 1 µm less there is one.
  EXPECT_TRUE(std::isnan(touchOfOneFinger(at(0.08 + 0.025 + 1e-6, 1.5), 0.02)));
  EXPECT_NEAR(touchOfOneFinger(at(0.08 + 0.025 - 1e-6, 1.5), 0.02), 3.0, tolerance(0.05));
  // Beyond the end of travel; and where the open end overlaps.
  EXPECT_TRUE(std::isnan(touchOfOneFinger(at(0.06, 3.0 + 0.43), 0.02)));
  EXPECT_EQ(touchOfOneFinger(at(0.06, 0.2), 0.02), -kInfinity);
}

/// The hand glides past a bottle at 0.15 m/s; `look` is called in every tick.
void glide(Still& still, int ticks, const std::function<void(const AxisPosition&)>& look) {
  still.body_pose.translation_m = {0.049, 0.041, 0.004};
  still.q[kFingers] = 1.1, still.q[kCircumduction] = 0.35;
  for (int k = 0; k < ticks; ++k) {
    const double turn = 5.0 * k * 1e-3;
    still.q[0] = 0.03 * std::sin(turn) - 0.02;
    still.q[1] = 0.03 * std::cos(turn) - 0.04;
    look(still.tick());
  }
}

TEST(FirstTouchOfAMovingHand, GlidingPastABottle_IsKnownToAFractionOfAMillimetre) {
  Still moving(sceneOf(cylinder(0.025, 0.2)));
  int ticks = 0, known = 0, right = 0;
  double worst_m = 0.0;
  glide(moving, 2500, [&](const AxisPosition& touch) {
    if (++ticks % 5 != 0) return;
    Still here(moving.scene);
    here.body_pose = moving.body_pose;
    here.q = moving.q;
    AxisPosition truth;
    for (int k = 0; k < 50; ++k) truth = here.tick();  // the tests above show that this is exact
    for (int a = kFingers; a <= kThumb; ++a) {
      ++known;
      const bool none = std::isnan(truth[a]) && std::isnan(touch[a]);
      if (none || truth[a] == touch[a]) ++right;
      if (!std::isfinite(truth[a]) || !std::isfinite(touch[a]) || truth[a] == touch[a]) continue;
      const double off_m =
          std::abs(touch[a] - truth[a]) * 0.08;  // along the path, at the lever arm
      right += off_m < 3e-4 ? 1 : 0;
      worst_m = std::max(worst_m, off_m);
    }
  });
  // Where another finger becomes the first to touch, the true value jumps; the reported one follows
  // one search later.
  const double share = static_cast<double>(right) / known;
  std::printf("figure: moving hand: %.2f %% right to 0.3 mm of path, worst %.2g mm\n",
              100.0 * share, worst_m * 1e3);
  EXPECT_GT(share, 0.95);
}

TEST(FirstTouchAskedFor, CalledAgainAfterReset_GivesTheSameBits) {
  Still still(sceneOf(cylinder(0.025, 0.2)));
  std::vector<AxisPosition> first, second;
  glide(still, 300, [&](const AxisPosition& touch) { first.push_back(touch); });
  still.closure.reset();
  glide(still, 300, [&](const AxisPosition& touch) { second.push_back(touch); });
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    ASSERT_EQ(0, std::memcmp(first[k].data(), second[k].data(), 6 * sizeof(double))) << k;
  }
}

TEST(FirstTouchAskedFor, BaseAxisOrUnrequestedAxis_IsNan) {
  Still still(sceneOf(cylinder(0.025, 0.2)));
  still.body_pose.translation_m = {0.049, 0.06, 0.004};
  AxisPosition touch;
  for (int k = 0; k < 50; ++k) touch = still.tick();
  for (int a = 0; a < kFingers; ++a) EXPECT_TRUE(std::isnan(touch[a]));
  EXPECT_FALSE(std::isnan(touch[kFingers]));
  for (const int nothing : {-1, 1, 32}) {
    touch = still.tick(nothing);
    ASSERT_EQ(touch.size(), 6);
    for (const double t : touch) EXPECT_TRUE(std::isnan(t));
  }
}

TEST(FirstTouchAskedFor, BodyPlacedElsewhere_IsFoundAgain) {
  Still still(sceneOf(cylinder(0.025, 0.2)));
  still.q[kCircumduction] = 0.35;
  for (const double y : {0.06, 0.045, 0.07, 0.4, 0.05}) {
    still.body_pose.translation_m = {0.049, y, 0.004};
    AxisPosition touch;
    for (int k = 0; k < 50; ++k) touch = still.tick();
    Still anew(still.scene);
    anew.body_pose = still.body_pose;
    anew.q = still.q;
    AxisPosition expected;
    for (int k = 0; k < 50; ++k) expected = anew.tick();
    EXPECT_EQ(std::isnan(touch[kFingers]), y == 0.4);
    for (int a = kFingers; a <= kThumb; ++a) {
      EXPECT_TRUE(touch[a] == expected[a] || std::abs(touch[a] - expected[a]) < 1e-5 ||
                  (std::isnan(touch[a]) && std::isnan(expected[a])))
          << y << ": " << touch[a] << " and not " << expected[a];
    }
  }
}

}  // namespace
}  // namespace wholehand::test
