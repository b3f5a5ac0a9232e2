// Force Dimension devices with a fake SDK: finding, opening and homing.
#include "fake_sdk.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <utility>

namespace wholehand::test {
namespace {

TEST(ForceDimensionSdk, UnsuitableSdk_IsRefusedWithTheMissingPart) {
  for (const auto& [sdk, why] : {std::pair{"none", "name its folder in FORCEDIM_SDK"},
                                 {"without_angle", "has no dhdGetGripperAngleRad"},
                                 {"old", "is SDK 3.13"},
                                 {"next", "is SDK 4.17"}}) {
    ForceDimensionDriver at(sdk);
    const auto driver = at.load();
    ASSERT_FALSE(driver) << sdk;
    EXPECT_TRUE(contains(at.said + whyNot(driver), why));
  }
}

TEST_F(ForceDimension, DriverInALoop_IsRefusedAndReferredToAHost) {
  EXPECT_TRUE(refusedWith(
      at.load("", std::string(kForceSettings) + kGripperSettings, CalledBy::kLoop), "a host can"));
}

TEST_F(ForceDimension, Open_MovesNothingAndSwitchesNoForceOn) {
  open();
  EXPECT_EQ(at.fake->inits, 0);
  EXPECT_EQ(at.fake->enables, 0);
  EXPECT_EQ(at.fake->sent, 0);
  const auto& axes = at.driver->axes();
  ASSERT_EQ(axes.size(), 4U);
  EXPECT_STREQ(axes[3].name, "finger_flexion");
  EXPECT_EQ(axes[3].upper, 1.6);
  EXPECT_NEAR(axes[3].effort_limit, 8.0 * 0.07 / 4.0, 1e-12);  // ratio 1.6 / 0.4
  EXPECT_EQ(axes[0].effort_limit, 12.0);
  EXPECT_EQ(axes[0].silence_s, 0.02);
  EXPECT_TRUE(contains(at.said, "fake.7, SDK 3.17.1"));
}

TEST_F(ForceDimension, SerialNumber_OpensThatDeviceAndClosesTheOthers) {
  open("serial:22222");
  EXPECT_EQ(at.fake->opened, 2);
  EXPECT_EQ(at.fake->closed, 1);
  EXPECT_EQ(at.driver->identity().serial, "22222");
  EXPECT_EQ(at.driver->identity().sdk, "3.17.1");
}

TEST_F(ForceDimension, DeviceNotFound_IsReportedWithTheAvailableOnes) {
  for (const auto& [locator, devices, why] : {std::tuple{"", 0, "no device: the fake says why"},
                                              {"serial:7", 2, "there are: 11111, 22222"},
                                              {"usb", 2, "names no device"},
                                              {"serial:12x", 2, "names no device"}}) {
    at.fake->devices = devices;
    EXPECT_TRUE(refusedWith(at.load(locator), why));
  }
}

TEST_F(ForceDimension, DeviceWithoutARequestedGripper_IsRefused) {
  at.fake->has_gripper = 0;
  EXPECT_TRUE(refusedWith(at.load(), "fake.7 has no gripper"));
  ASSERT_TRUE(at.load("", kForceSettings));
  EXPECT_EQ(at.driver->axes().size(), 3U);
}

TEST_F(ForceDimension, InvalidSettings_AreRefused) {
  const auto driver = at.load("", std::string(kForceSettings) + "watchdog = 3\n");
  ASSERT_FALSE(driver);
  const std::string gripper = replaced(kGripperSettings, "open_rad = 0.5", "open_rad = 0.1");
  const auto crossed =
      at.load("", kForceSettings + replaced(gripper, "closed_rad = 0.1", "closed_rad = 0.5"));
  ASSERT_FALSE(crossed);
  EXPECT_TRUE(contains(at.said, "is not below open_rad"));
}

TEST_F(ForceDimension, UnhomedDevice_HomesOnlyOnRequestAndLeavesForceOff) {
  at.fake->initialized = 0;
  open();
  ASSERT_TRUE(at.driver->control(WH_ENABLE, 0.0));
  EXPECT_EQ(at.read().status, static_cast<std::uint32_t>(WH_ENABLED));
  EXPECT_EQ(at.fake->inits, 0);
  EXPECT_FALSE(at.driver->control(WH_HOME, 0.0)) << "it would move with its force on";
  EXPECT_EQ(at.fake->inits, 0);
  ASSERT_TRUE(at.driver->control(WH_DISABLE, 0.0));
  ASSERT_TRUE(at.driver->control(WH_HOME, 0.0)) << at.said;
  EXPECT_EQ(at.fake->inits, 1);
  EXPECT_EQ(at.fake->stops, 1);
  EXPECT_EQ(at.fake->stops_that_leave_force_on, 0);
  EXPECT_EQ(at.fake->force_on, 0);
  EXPECT_EQ(at.read().status, static_cast<std::uint32_t>(WH_HOMED));
}

TEST_F(ForceDimension, FailedHoming_IsReportedAndForceIsOff) {
  at.fake->initialized = 0;
  at.fake->init_returns = -1;
  open();
  EXPECT_FALSE(at.driver->control(WH_HOME, 0.0));
  EXPECT_TRUE(contains(at.said, "homing failed: the fake says why"));
  EXPECT_EQ(at.fake->stops, 1) << "whatever it had begun ends";
  EXPECT_EQ(at.read().status & WH_HOMED, 0U);
}

TEST(ForceDimensionSettings, ShippedExample_IsAccepted) {
  ForceDimensionDriver at;
  const auto driver =
      at.load("", bytesOfFile(WHOLEHAND_SOURCE_DIR "/drivers/force_dimension/lambda-7.toml"));
  EXPECT_TRUE(driver) << whyNot(driver);
}

}  // namespace
}  // namespace wholehand::test
