// Drivers that are loaded from shared objects built by a C compiler against the public header.
#include "device/plugin/plugin_device.hpp"

#include "device/plugin/observed_driver.hpp"
#include "device/plugin/plugin_driver.hpp"
#include "realtime/allocation_counter.hpp"
#include "spoiled_places.hpp"
#include "support/rig_tools.hpp"
#include "support/says.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

std::string driverFile(const std::string& name) {
  return std::string(WHOLEHAND_BINARY_DIR) + "/drivers/" + name + ".so";
}

DeviceModel desktopInARig() {
  return load(shippedFiles("desktop-3axis", "empty", "adult-median-right", "no-arm")).device;
}

Expected<std::shared_ptr<PluginDriver>> loadSpoiled(const std::string& settings,
                                                    const std::string& locator = "") {
  return PluginDriver::load({driverFile("spoiled"), locator, settings});
}

std::unique_ptr<HapticDevice> deviceThat(const std::string& settings) {
  return orThrow(PluginDevice::make(orThrow(loadSpoiled(settings)), desktopInARig(), 1e-3));
}

TEST(PluginDriver, BrokenOne_IsRefusedByName) {
  for (const auto& [driver, why] : {std::pair{"no_symbol", "has no wh_plugin_v1()"},
                                    {"other_major", "is built for version 2"},
                                    {"too_short", "too short"},
                                    {"without_write", "leaves out one of its six"},
                                    {"may_wait", "WH_NEVER_WAITS"},
                                    {"not_there", "cannot open shared object file"}}) {
    const auto loaded = PluginDriver::load({driverFile(driver), "", ""});
    EXPECT_TRUE(refusedWith(loaded, driver));  // the file
    EXPECT_TRUE(refusedWith(loaded, why));
  }
}

TEST(PluginDriver, DeviceThatIsNotFound_SaysWhereAndWhatTheDriverSaid) {
  const auto driver = loadSpoiled("", "nowhere");
  EXPECT_TRUE(refusedWith(driver, "no device was found at nowhere: nothing answers"));
}

TEST(PluginDriver, ThatKnowsItsDevice_SaysSerialFirmwareAndSdk) {
  const auto driver = orThrow(loadSpoiled(""));
  EXPECT_EQ(driver->identity().serial, "S-1");
  EXPECT_EQ(driver->identity().firmware, "1.0");
  EXPECT_EQ(driver->identity().sdk, "7");
  EXPECT_EQ(orThrow(loadSpoiled("anonymous"))->identity().serial, "");
}

TEST(PluginDriver, BuiltWithTheHeaderOf1_0_WorksAndIsNotAskedWhoItIs) {
  const auto driver = orThrow(PluginDriver::load({driverFile("older"), "", ""}));
  EXPECT_EQ(driver->identity().serial, "");
  EXPECT_TRUE(PluginDevice::make(driver, desktopInARig(), 1e-3).ok());
}

TEST(PluginDevice, OtherThanTheFileStates_IsRefusedWithTheAxis) {
  for (const auto& [settings, why] : {std::pair{"nameless", "has no such axis"},
                                      {"turning", "has a rotation"},
                                      {"brake", "takes no effort there"},
                                      {"short", "travel down to"},
                                      {"weak", "has an effort limit of 1, the file states 8"},
                                      {"coarse", "has steps of position of 0.001"},
                                      {"slow", "has a delay of 0.005, the file states 0.001"},
                                      {"deaf", "has no watchdog"}}) {
    const auto device = PluginDevice::make(orThrow(loadSpoiled(settings)), desktopInARig(), 1e-3);
    EXPECT_TRUE(refusedWith(device, why));
    ASSERT_EQ(device.errors().size(), 1U) << format(device.errors());
    EXPECT_EQ(device.errors().front().value, "x");
  }
  EXPECT_TRUE(refusedWith(loadSpoiled("many"), "has 17 axes"));
  EXPECT_TRUE(refusedWith(loadSpoiled("axisless"), "has 0 axes"));
}

TEST(PluginDevice, AxesInAnotherOrder_ArePutWhereTheFileHasThem) {
  const auto driver = orThrow(loadSpoiled(""));
  const auto device = orThrow(PluginDevice::make(driver, desktopInARig(), 1e-3));
  ASSERT_NO_FATAL_FAILURE(expectPlacesOfSpoiled(*device));
  AxisEffort effort(3);
  effort[0] = 0.5, effort[1] = -0.25, effort[2] = 2.0;
  ASSERT_EQ(device->write(effort), Fault::kNone);
  wh_sample sample{};
  ASSERT_GE(driver->read(sample), 0);
  EXPECT_EQ(sample.effort[3], 0.5);
  EXPECT_EQ(sample.effort[2], -0.25);
  EXPECT_EQ(sample.effort[0], 2.0);
  EXPECT_EQ(sample.effort[1], 0.0) << "an axis that the file does not name";
  device->close();
  ASSERT_GE(driver->read(sample), 0);
  EXPECT_EQ(sample.effort[3], 0.0);
  DeviceReading reading;
  EXPECT_EQ(device->read(reading, 1), Fault::kDeviceRead) << "closed";
}

TEST(PluginDevice, ReadsAndWrites_AllocateNothing) {
  const auto device = deviceThat("");
  ASSERT_TRUE(device->open());
  DeviceReading reading;
  AxisEffort effort(3);
  ASSERT_EQ(device->read(reading, 1), Fault::kNone);
  const std::uint64_t before = threadAllocations();
  for (int i = 0; i < 1000; ++i) {
    (void)device->read(reading, 1);
    (void)device->write(effort);
  }
  EXPECT_EQ(threadAllocations(), before);
}

TEST(PluginDevice, NotHomedOrLocked_IsNotArmed) {
  for (const char* settings : {"unhomed", "drive", "enable", "unplug", "locked"}) {
    const auto device = deviceThat(settings);
    const bool may = device->open() && device->ready();
    EXPECT_FALSE(may) << settings;
  }
}

TEST(ObservedDriver, NewestSample_IsKeptForOtherThreads) {
  const auto observed = std::make_shared<ObservedDriver>(orThrow(loadSpoiled("silenced@3")));
  const auto device = orThrow(PluginDevice::make(observed, desktopInARig(), 1e-3));
  EXPECT_EQ(observed->facts().sampled_ns, 0) << "nothing was read yet";
  ASSERT_TRUE(device->open());
  DeviceReading reading;
  ASSERT_EQ(device->read(reading, 1), Fault::kNone);
  EXPECT_TRUE(observed->facts().enabled);
  EXPECT_TRUE(observed->facts().homed);
  EXPECT_FALSE(observed->facts().silenced);
  EXPECT_TRUE(std::isnan(observed->facts().temperature_c)) << "the driver does not say";
  EXPECT_EQ(observed->facts().sampled_ns, 1'000'000) << "spoiled_driver.c: sample n is of n ms";
  (void)device->read(reading, 1), (void)device->read(reading, 1);
  EXPECT_TRUE(observed->facts().silenced);
  device->close();
  EXPECT_FALSE(observed->facts().enabled) << "nobody reads any more";
}

struct FailingInATick {
  const char* name;
  Fault told;
  int within = 0;  ///< ticks after the sample that says so
};

class FailingDevice : public testing::TestWithParam<FailingInATick> {};

// A whole rig: the ramp begins in the tick whose sample says so, and ends at neutral.
TEST_P(FailingDevice, InATick_IsToldAndRampsToNeutral) {
  constexpr int kAt = 60;  // samples: one by ready(), one by arm(), then one a tick
  Models models = load(shippedFiles("desktop-3axis", "empty", "adult-median-right", "no-arm"));
  auto device = deviceThat(std::string(GetParam().name) + "@" + std::to_string(kAt));
  auto rig = orThrow(buildRigWithoutPerson(std::move(models), std::move(device), {}));
  ASSERT_TRUE(rig->renderer->arm());
  TickRecord record;
  int first = -1, neutral = -1;
  for (int tick = 0; tick < 300 && neutral < 0; ++tick) {
    record.tick = static_cast<std::uint64_t>(tick);
    record.command_count = 0;
    rig->renderer->tick(1, record);
    if (first < 0 && any(record.faults & GetParam().told)) first = tick;
    if (first < 0) {
      ASSERT_FALSE(any(record.faults & kStopping)) << "tick " << tick;
    }
    if (rig->renderer->finished()) neutral = tick;
  }
  ASSERT_GE(first, 0) << "never told";
  EXPECT_EQ(first, kAt - 3 + GetParam().within);
  if (any(GetParam().told & kStopping)) {
    EXPECT_EQ(record.safety_state, SafetyState::kFaulted);
    if (GetParam().told != Fault::kDeviceWrite) {
      EXPECT_LE(neutral - first, 100);
    }
  } else {
    EXPECT_EQ(neutral, -1) << "goes on";
  }
}
// The sample after the first frozen one is 1 period old, and 20 ms are allowed.
const std::vector<FailingInATick> kFailing = {
    {"unplug", Fault::kDeviceRead},      {"missing", Fault::kDeviceRead},
    {"nan", Fault::kNonFinitePosition},  {"drive", Fault::kDriveFault},
    {"enable", Fault::kEnableLost},      {"unhomed", Fault::kEnableLost},
    {"silenced", Fault::kEnableLost},    {"hot", Fault::kDriveHot},
    {"backwards", Fault::kStaleSample},  {"clock", Fault::kStaleSample},
    {"frozen", Fault::kStaleSample, 21}, {"refuse", Fault::kDeviceWrite}};
INSTANTIATE_TEST_SUITE_P(Kinds, FailingDevice, testing::ValuesIn(aTenth(kFailing)),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace wholehand::test
