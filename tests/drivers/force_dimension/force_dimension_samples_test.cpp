// Force Dimension devices with a fake SDK: samples and efforts.
#include "fake_sdk.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

TEST_F(ForceDimension, ForceLeftByAnotherProgram_IsClearedBeforeEnable) {
  open();
  at.fake->force[2] = 5.0;
  ASSERT_TRUE(at.driver->control(WH_ENABLE, 0.0));
  EXPECT_EQ(at.fake->enables_with_a_force, 0);
}

TEST_F(ForceDimension, ForceButton_DecidesWhetherItIsEnabled) {
  at.fake->waits_for_button = 1;
  enable();
  EXPECT_TRUE(contains(at.said, "press it"));
  EXPECT_EQ(at.read().status & WH_ENABLED, 0U);
  at.fake->force_on = 1;  // a person presses it
  EXPECT_EQ(at.read().status, static_cast<std::uint32_t>(WH_ENABLED | WH_HOMED));
}

TEST_F(ForceDimension, ForceOff_IsReportedWithItsCodeAndItsReason) {
  struct Cause {
    int code;
    std::uint32_t bits;
    const char* expected;
  };
  open();
  for (const Cause& cause : {Cause{1, 0, "force button"},
                             {2, WH_DRIVE_FAULT, "faster than its own limit"},
                             {3, WH_SILENCED, "watchdog"},
                             {4, 0, "a program"},
                             {5, 0, "USB"},
                             {6, 0, "dead man"},
                             {9, 0, "not known"}}) {
    ASSERT_TRUE(at.driver->control(WH_ENABLE, 0.0)) << at.said;
    at.fake->force_on = 0;
    at.fake->cause = cause.code;
    const wh_sample sample = at.read();
    EXPECT_EQ(sample.status, cause.bits | WH_HOMED) << cause.expected;
    EXPECT_EQ(sample.vendor_code, cause.code);
    at.said.clear();
    (void)at.driver->control(WH_DISABLE, 0.0);
    EXPECT_TRUE(contains(at.said, cause.expected));
  }
}

TEST_F(ForceDimension, ControllerError_IsADriveFault) {
  enable();
  at.fake->error = 1;
  const wh_sample sample = at.read();
  EXPECT_NE(sample.status & WH_DRIVE_FAULT, 0U);
  EXPECT_EQ(sample.vendor_code, 16);
}

TEST_F(ForceDimension, PowerCycle_LosesTheHoming) {
  enable();
  at.fake->reset = 1;
  EXPECT_EQ(at.read().status & WH_HOMED, 0U);
  at.fake->reset = 0;
  EXPECT_EQ(at.read().status & WH_HOMED, 0U) << "until somebody homes it";
}

TEST_F(ForceDimension, Unplugged_FailsReadsAndWrites) {
  enable();
  ASSERT_GE(at.driver->control(WH_ENABLE, 0.0).ok(), true);
  at.fake->connected = 0;
  (void)at.read();
  EXPECT_EQ(at.returned, WH_FAILED);
  at.fake->connected = 1;
  for (int* broken :
       {&at.fake->status_returns, &at.fake->position_returns, &at.fake->angle_returns}) {
    *broken = -1;
    (void)at.read();
    EXPECT_EQ(at.returned, WH_FAILED);
    *broken = 0;
  }
  at.fake->force_returns = -1;
  EXPECT_EQ(at.write({0, 0, 0, 0}), WH_FAILED);
  at.fake->force_returns = 0;
  at.fake->enable_returns = -1;
  EXPECT_FALSE(at.driver->control(WH_ENABLE, 0.0));
  EXPECT_EQ(at.write({0, 0, 0, 0}), WH_FAILED) << "not enabled";
}

TEST_F(ForceDimension, TimeGuard_ReportsNothingNewAndKeepsTheLastSample) {
  enable();
  at.fake->position_m[2] = 0.01;
  const wh_sample first = at.read();
  EXPECT_EQ(at.returned, WH_OK);
  for (int* guarded : {&at.fake->position_returns, &at.fake->angle_returns}) {
    *guarded = 1;
    at.fake->position_m[2] = 0.05;
    const wh_sample again = at.read();
    EXPECT_EQ(at.returned, WH_NOTHING_NEW);
    EXPECT_EQ(again.sequence, first.sequence);
    EXPECT_EQ(again.position[2], 0.01);
    at.fake->force_on = 0;
    EXPECT_EQ(at.read().status & WH_ENABLED, 0U) << "what stops is reported at once";
    at.fake->force_on = 1;
    *guarded = 0;
  }
  EXPECT_EQ(at.read().sequence, first.sequence + 1);
  at.fake->force_returns = 1;
  EXPECT_EQ(at.write({0, 0, 0, 0}), WH_OK);
}

TEST_F(ForceDimension, SaturatedMotor_IsNoFault) {
  enable();
  at.fake->force_returns = 2;
  EXPECT_EQ(at.write({1, 0, 0, 0}), WH_OK);
  EXPECT_EQ(at.read().status, static_cast<std::uint32_t>(WH_ENABLED | WH_HOMED | WH_SATURATED));
  at.fake->force_returns = 0;
  EXPECT_EQ(at.write({1, 0, 0, 0}), WH_OK);
  EXPECT_EQ(at.read().status & WH_SATURATED, 0U);
}

// The device's x points to the person and its y to the right; ours point away and to the left.
TEST_F(ForceDimension, Frame_IsTurnedAboutTheVertical) {
  enable();
  at.fake->position_m[0] = 0.01, at.fake->position_m[1] = 0.02, at.fake->position_m[2] = 0.03;
  const wh_sample sample = at.read();
  EXPECT_NEAR(sample.position[0], -0.01, 1e-15);
  EXPECT_NEAR(sample.position[1], -0.02, 1e-15);
  EXPECT_EQ(sample.position[2], 0.03);
  ASSERT_EQ(at.write({1.0, 2.0, 3.0, 0.0}), WH_OK);
  EXPECT_NEAR(at.fake->force[0], -1.0, 1e-12);
  EXPECT_NEAR(at.fake->force[1], -2.0, 1e-12);
  EXPECT_EQ(at.fake->force[2], 3.0);
}

class Handed : public testing::TestWithParam<int> {};
// Virtual work is the closed form: the work of the axes equals that of the device.
TEST_P(Handed, RandomMoves_DoTheSameWorkOnBothSides) {
  auto random = seededRandom(3);
  std::uniform_real_distribution<double> in(-1.0, 1.0);
  ForceDimensionDriver at;
  at.fake->left_handed = GetParam();
  const std::string settings =  // a frame turned by 0.7 rad
      replaced(kForceSettings, "3.141592653589793", "0.7") + kGripperSettings;
  ASSERT_TRUE(at.load("", settings)) << at.said;
  ASSERT_TRUE(at.driver->control(WH_ENABLE, 0.0));
  const double sign =
      GetParam() != 0 ? -1.0 : 1.0;  // sign of the SDK's angle for a left-hand gripper
  for (int i = 0; i < 1000; ++i) {
    double before[4], moved[4];
    const auto draw = [&](double* q) {
      for (double& x : at.fake->position_m) x = 0.1 * in(random);
      at.fake->angle_rad = 0.3 + 0.2 * in(random);
      const wh_sample sample = at.read();
      std::copy_n(sample.position, 4, q);
    };
    draw(before);
    const fake_device first = *at.fake;
    draw(moved);
    const std::vector<double> effort = {5 * in(random), 5 * in(random), 5 * in(random),
                                        0.1 * in(random)};
    ASSERT_EQ(at.write(effort), WH_OK);
    double axes_j = 0.0, device_j = 0.0;
    for (std::size_t a = 0; a < 4; ++a) axes_j += effort[a] * (moved[a] - before[a]);
    for (int a = 0; a < 3; ++a) {
      device_j += at.fake->force[a] * (at.fake->position_m[a] - first.position_m[a]);
    }
    device_j += at.fake->force[6] * 0.07 * sign * (at.fake->angle_rad - first.angle_rad);
    ASSERT_NEAR(axes_j, device_j, 1e-12);
  }
}
INSTANTIATE_TEST_SUITE_P(Hands, Handed, testing::Values(0, 1));

TEST_F(ForceDimension, OpenGripper_IsAStraightFingerAndClosedABentOne) {
  for (const int left : {0, 1}) {
    ForceDimensionDriver hand;
    hand.fake->left_handed = left;
    ASSERT_TRUE(hand.load());
    hand.fake->angle_rad = 0.5;
    EXPECT_NEAR(hand.read().position[3], 0.0, 1e-12);
    hand.fake->angle_rad = 0.1;
    EXPECT_NEAR(hand.read().position[3], 1.6, 1e-12);
  }
}

TEST_F(ForceDimension, ImpossibleCommands_AreRefusedOrClamped) {
  enable();
  const int sent = at.fake->sent;
  EXPECT_EQ(at.write({std::nan(""), 0, 0, 0}), WH_FAILED);
  EXPECT_EQ(at.write({0, 0, std::numeric_limits<double>::infinity(), 0}), WH_FAILED);
  EXPECT_EQ(at.write({0, 0, 0}), WH_FAILED);
  EXPECT_EQ(at.write({0, 0, 0, 0, 0}), WH_FAILED) << "nobody knows which axis is which";
  EXPECT_EQ(at.fake->sent, sent);
  ASSERT_EQ(at.write({0, 0, 100.0, 100.0}), WH_OK);
  EXPECT_EQ(at.fake->force[2], 12.0);
  EXPECT_NEAR(at.fake->force[6], -8.0, 1e-12);
}

TEST_F(ForceDimension, DroppedWatchdog_SendsNothingMore) {
  enable();
  ASSERT_TRUE(at.driver->control(WH_DROP_WATCHDOG, 0.0));
  const int sent = at.fake->sent;
  EXPECT_EQ(at.write({1, 0, 0, 0}), WH_OK);
  EXPECT_EQ(at.fake->sent, sent);
}

TEST_F(ForceDimension, ClosedDevice_HasNoForceAndUnchangedVendorLimits) {
  enable();
  ASSERT_EQ(at.write({1, 1, 1, 0.05}), WH_OK);
  (void)at.read();
  at.driver.reset();
  EXPECT_EQ(at.fake->closed, 1);
  EXPECT_EQ(at.fake->force_on, 0);
  for (const double force : at.fake->force) EXPECT_EQ(force, 0.0);
  EXPECT_EQ(at.fake->forbidden, 0);
}

}  // namespace
}  // namespace wholehand::test
