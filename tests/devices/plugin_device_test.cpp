// Loads drivers from shared objects that a C compiler built with the public header.
#include "devices/plugin/plugin_device.hpp"

#include "devices/plain_driver.hpp"
#include "devices/plugin/device_driver.hpp"
#include "devices/plugin/plugin_driver.hpp"
#include "faulty_places.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <numbers>
#include <set>
#include <string>
#include <thread>
#include <vector>

namespace wholehand::test {
namespace {

std::string driverFile(const std::string& name) {
  return std::string(WHOLEHAND_BINARY_DIR) + "/drivers/" + name + ".so";
}

DeviceModel desktopInARig() {
  static const DeviceModel kModel =
      load(shippedFiles("desktop-3axis", "empty", "adult-median-right", "no-arm")).device;
  return kModel;
}

Expected<std::shared_ptr<PluginDriver>> loadFaulty(const std::string& settings,
                                                   const std::string& locator = "") {
  return PluginDriver::load({driverFile("faulty"), locator, settings});
}

std::unique_ptr<HapticDevice> deviceThat(const std::string& settings) {
  return orThrow(PluginDevice::make(orThrow(loadFaulty(settings)), desktopInARig(), 1e-3));
}

TEST(PluginDriver, BrokenDriver_IsRefusedByName) {
  for (const auto& [driver, why] : {std::pair{"no_symbol", "has no wh_plugin_v1()"},
                                    {"other_major", "is built for version 2"},
                                    {"too_short", "too short"},
                                    {"without_write", "leaves out one of its six"},
                                    {"may_wait", "WH_NEVER_WAITS"},
                                    {"not_there", "cannot open shared object file"}}) {
    const auto loaded = PluginDriver::load({driverFile(driver), "", ""});
    EXPECT_TRUE(refusedWith(loaded, driver));  // names the file
    EXPECT_TRUE(refusedWith(loaded, why));
  }
}

TEST(PluginDriver, DeviceNotFound_IsReportedWithLocationAndDriverMessage) {
  const auto driver = loadFaulty("", "nowhere");
  EXPECT_TRUE(refusedWith(driver, "no device was found at nowhere: nothing answers"));
}

TEST(PluginDriver, DriverThatKnowsItsDevice_ReportsSerialFirmwareAndSdk) {
  const auto driver = orThrow(loadFaulty(""));
  EXPECT_EQ(driver->identity().serial, "S-1");
  EXPECT_EQ(driver->identity().firmware, "1.0");
  EXPECT_EQ(driver->identity().sdk, "7");
  EXPECT_EQ(orThrow(loadFaulty("anonymous"))->identity().serial, "");
}

// A passport covers everything of this machine between an effort and the motor.
TEST(PluginDriver, ChangedDriverSettingsOrNamedFile_ChangesTheDigest) {
  const Folder folder;
  const auto digest = [](const std::string& driver, const std::string& settings) {
    return orThrow(PluginDriver::load({driverFile(driver), "", settings}))
        ->identity()
        .driver_sha256;
  };
  const std::string map = folder.file("map.toml");
  std::ofstream(map) << "gear = 1";
  const std::string first = digest("faulty", map);
  EXPECT_EQ(digest("faulty", map), first);
  std::set<std::string> all = {first, digest("faulty", "gear=1"), digest("faulty", "gear=-3"),
                               digest("older", "gear=1")};
  std::ofstream(map) << "gear = -3";
  all.insert(digest("faulty", map));
  EXPECT_EQ(all.size(), 5U);
  for (const char* name : {"a b", "a=b"}) {
    std::filesystem::create_directory(folder.file(name));
    const std::string file = folder.file(std::string(name) + "/map.toml");
    for (const std::string& settings : {file, "map=" + file}) {
      if (settings != file && file.find(' ') != std::string::npos)
        continue;  // a path with spaces is not one word
      std::ofstream(file) << "max_torque_nm = 0.8";
      const std::string safe = digest("faulty", settings);
      EXPECT_EQ(digest("faulty", settings), safe);
      std::ofstream(file) << "max_torque_nm = 8.0";
      EXPECT_NE(digest("faulty", settings), safe) << settings;
    }
  }
}

TEST(PluginDevice, DeviceThatMayMoveAPerson_IsNotArmedWithoutAPermit) {
  const auto refusalOf = [](std::optional<ArmingPermit> permit) {
    Models models = load(shippedFiles("desktop-3axis", "empty", "adult-median-right", "no-arm"));
    auto device = orThrow(
        PluginDevice::make(orThrow(loadFaulty("")), models.device, 1e-3, std::move(permit)));
    const auto rig = orThrow(buildRig(std::move(models), std::move(device), {}));
    return rig->renderer->arm();
  };
  EXPECT_TRUE(refusedWith(refusalOf(std::nullopt), "passport"));
  EXPECT_TRUE(refusedWith(refusalOf(ArmingPermit::withoutPassport()), "nothing was rehearsed"))
      << "the next gate";
}

TEST(PluginDriver, DriverBuiltWithHeader1_0_WorksWithoutAnIdentity) {
  const auto driver = orThrow(PluginDriver::load({driverFile("older"), "", ""}));
  EXPECT_EQ(driver->identity().serial, "");
  EXPECT_TRUE(PluginDevice::make(driver, desktopInARig(), 1e-3).ok());
}

TEST(PluginDevice, DeviceThatDiffersFromItsFile_IsRefusedWithTheAxis) {
  for (const auto& [settings, why] : {std::pair{"nameless", "has no such axis"},
                                      {"turning", "has a rotation"},
                                      {"brake", "takes no effort there"},
                                      {"short", "travel down to"},
                                      {"weak", "has an effort limit of 1, the file states 8"},
                                      {"coarse", "has steps of position of 0.001"},
                                      {"slow", "has a delay of 0.005, the file states 0.001"},
                                      {"deaf", "has no watchdog"}}) {
    const auto device = PluginDevice::make(orThrow(loadFaulty(settings)), desktopInARig(), 1e-3);
    EXPECT_TRUE(refusedWith(device, why));
    ASSERT_EQ(device.errors().size(), 1U) << format(device.errors());
    EXPECT_EQ(device.errors().front().value, "x");
  }
  EXPECT_TRUE(refusedWith(loadFaulty("many"), "has 17 axes"));
  EXPECT_TRUE(refusedWith(loadFaulty("axisless"), "has 0 axes"));
}

TEST(PluginDevice, AxesInAnotherOrder_AreMappedToTheFilesOrder) {
  const auto driver = orThrow(loadFaulty(""));
  const auto device = orThrow(PluginDevice::make(driver, desktopInARig(), 1e-3));
  ASSERT_NO_FATAL_FAILURE(expectPlacesOfFaultyDriver(*device));
  ASSERT_TRUE(device->enable());
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

TEST(PluginDevice, FailedEnable_IsUndone) {
  for (const char* settings : {"locked", "enable"}) {
    const auto driver = orThrow(loadFaulty(settings));
    const auto device = orThrow(PluginDevice::make(driver, desktopInARig(), 1e-3));
    ASSERT_TRUE(device->open());
    EXPECT_FALSE(device->enable());
    EXPECT_EQ(device->write(AxisEffort(3, 1.0)), Fault::kDeviceWrite);
    wh_command command{};
    command.size = sizeof(command);
    command.axes = 4;
    command.sequence = 1;
    EXPECT_LT(driver->write(command), 0) << settings << ": it is disabled again";
  }
}

TEST(PluginDevice, UnhomedOrLockedDevice_IsNotArmed) {
  for (const char* settings : {"unhomed", "drive", "enable", "unplug", "locked"}) {
    const auto device = deviceThat(settings);
    const bool may = device->open() && device->ready() && device->enable();
    EXPECT_FALSE(may) << settings;
  }
}

TEST(ObservedDriver, NewestSample_IsKeptForOtherThreads) {
  const auto observed = std::make_shared<ObservedDriver>(orThrow(loadFaulty("silenced@4")));
  const auto device = orThrow(PluginDevice::make(observed, desktopInARig(), 1e-3));
  EXPECT_EQ(observed->facts().sampled_ns, 0) << "nothing was read yet";
  ASSERT_TRUE(device->open());
  ASSERT_TRUE(device->enable());
  DeviceReading reading;
  const std::int64_t before_ns = monotonicNow_ns();
  ASSERT_EQ(device->read(reading, 1), Fault::kNone);
  EXPECT_TRUE(observed->facts().enabled);
  EXPECT_TRUE(observed->facts().homed);
  EXPECT_FALSE(observed->facts().silenced);
  EXPECT_TRUE(std::isnan(observed->facts().temperature_c)) << "the driver does not say";
  EXPECT_GE(observed->facts().sampled_ns, before_ns);
  EXPECT_LE(observed->facts().sampled_ns, monotonicNow_ns());
  (void)device->read(reading, 1), (void)device->read(reading, 1);
  EXPECT_TRUE(observed->facts().silenced);
  device->close();
  EXPECT_FALSE(observed->facts().enabled) << "nobody reads any more";
}

// The reader is another thread: the one that calls the driver is in the call.
TEST(ObservedDriver, CallThatDoesNotReturn_IsOverdueUntilItReturns) {
  for (const char* call : {"read", "write", "enable", "disable"}) {
    const Folder folder;
    const std::string file = folder.path() + "/hangs";
    const auto observed = std::make_shared<ObservedDriver>(
        orThrow(PluginDriver::load({driverFile("hanging"), "", std::string(call) + " " + file})));
    const auto device = orThrow(PluginDevice::make(observed, desktopInARig(), 1e-3));
    const auto use = [&] {
      DeviceReading reading;
      const bool done = device->open() && device->enable() &&
                        device->read(reading, 1) == Fault::kNone &&
                        device->write(AxisEffort(3)) == Fault::kNone;
      device->close();
      return done;
    };
    EXPECT_EQ(observed->switchesWithin_s(), 0.05) << "unless the driver states another time";
    EXPECT_TRUE(use()) << call;
    EXPECT_FALSE(observed->facts().overdue) << call;
    { const std::ofstream hangs(file); }
    std::future<bool> used = std::async(std::launch::async, use);
    while (!observed->facts().overdue) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::filesystem::remove(file);
    EXPECT_TRUE(used.get()) << call;
    EXPECT_FALSE(observed->facts().overdue) << call;
  }
}

// While a driver is opened or closed there is neither page nor loop: the report says it.
TEST(PluginDriver, OpeningOrClosingThatDoesNotReturn_IsReportedUntilItReturns) {
  for (const char* call : {"open", "describe", "identify", "close"}) {
    const Folder folder;
    const std::string file = folder.path() + "/hangs";
    { const std::ofstream hangs(file); }
    std::mutex mutex;
    std::vector<std::string> said;
    const auto heard = [&](std::size_t lines) {
      const std::lock_guard lock(mutex);
      return said.size() >= lines;
    };
    std::future<bool> used = std::async(std::launch::async, [&] {
      return PluginDriver::load({driverFile("hanging"), "", std::string(call) + " " + file},
                                [&](const std::string& line) {
                                  const std::lock_guard lock(mutex);
                                  said.push_back(line);
                                })
          .ok();
    });
    while (!heard(1)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::filesystem::remove(file);
    EXPECT_TRUE(used.get()) << call;
    EXPECT_EQ(said, (std::vector<std::string>{kNoAnswer, kAnswersAgain})) << call;
  }
}

struct FailingInATick {
  const char* name;
  Fault reported;
  int within = 0;  ///< largest number of ticks after the reporting sample
};

class FailingDevice : public testing::TestWithParam<FailingInATick> {};

// In a whole rig, the ramp begins in the tick whose sample reports the fault, and ends at neutral.
TEST_P(FailingDevice, FaultInATick_IsReportedAndRampsToNeutral) {
  constexpr int kAt = 60;  // number of the sample: ready(), prepare() and enable() read some, then
                           // each tick reads one
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
    if (first < 0 && any(record.faults & GetParam().reported)) first = tick;
    if (first < 0) {
      ASSERT_FALSE(any(record.faults & kStoppingFaults)) << "tick " << tick;
    }
    if (rig->renderer->finished()) neutral = tick;
  }
  ASSERT_GE(first, 0) << "never reported";
  EXPECT_EQ(first, kAt - 4 + GetParam().within);
  if (any(GetParam().reported & kStoppingFaults)) {
    EXPECT_EQ(record.safety_state, SafetyState::kFaulted);
    if (GetParam().reported != Fault::kDeviceWrite) {
      EXPECT_LE(neutral - first, 100);
    }
  } else {
    EXPECT_EQ(neutral, -1) << "goes on";
  }
}
// The sample after the first frozen one is 1 period old; 20 ms are allowed.
const std::vector<FailingInATick> kFailing = {
    {"unplug", Fault::kDeviceRead},      {"missing", Fault::kDeviceRead},
    {"nan", Fault::kNonFinitePosition},  {"drive", Fault::kDriveFault},
    {"enable", Fault::kEnableLost},      {"unhomed", Fault::kEnableLost},
    {"silenced", Fault::kEnableLost},    {"hot", Fault::kDriveHot},
    {"backwards", Fault::kStaleSample},  {"clock", Fault::kStaleSample},
    {"frozen", Fault::kStaleSample, 21}, {"refuse", Fault::kDeviceWrite}};
INSTANTIATE_TEST_SUITE_P(Kinds, FailingDevice, testing::ValuesIn(sampleTenth(kFailing)),
                         [](const auto& tested) { return tested.param.name; });

/// A driver whose samples have the age and efforts that the test sets, on the test's clock; their
/// sequence always rises.
std::int64_t g_now_ns = 0;
class AgedDriver final : public PlainDriver {
 public:
  AgedDriver() : PlainDriver({"x", "y", "z", "gripper"}, plainAxis()) {}
  [[nodiscard]] bool enablesAtNeutral() const noexcept override { return true; }
  [[nodiscard]] bool holds() const noexcept override { return true; }
  [[nodiscard]] Expected<Done> enable(const wh_command& neutral) override {
    std::fill(commanded.begin(), commanded.end(), neutral);
    return control(WH_ENABLE, 0.0);
  }
  [[nodiscard]] int read(wh_sample& sample) noexcept override {
    sample.size = sizeof(sample);
    sample.sequence = ++samples_;
    taken_ns_ = std::max(taken_ns_, g_now_ns - age_ns);
    sample.monotonic_ns = taken_ns_;
    sample.status = WH_HOMED | (enabled ? static_cast<std::uint32_t>(WH_ENABLED) : 0U);
    sample.valid = 7;
    sample.status |= status;
    sample.derating = derating;
    for (std::size_t a = 0; a < 3; ++a)
      sample.effort[a] = commanded[commanded.size() - 1 - late].effort[a];
    sample.effort[odd] = gain * sample.effort[odd] + bias;
    sample.effort[3] = unlisted;
    return WH_OK;
  }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    if (refuses) return WH_FAILED;
    commanded.push_back(command);
    commanded.pop_front();
    return WH_OK;
  }
  std::int64_t age_ns = 0;
  std::uint32_t status = 0, derating = 0;
  std::size_t late = 0, odd = 0;  ///< ticks until an effort acts; the axis with a wrong effort
  double gain = 1.0, bias = 0.0;
  double unlisted = 0.0;  ///< effort of the gripper
  bool refuses = false;
  std::deque<wh_command> commanded = std::deque<wh_command>(8);

 private:
  std::uint64_t samples_ = 0;
  std::int64_t taken_ns_ = 0;
};

/// An enabled device of 1 kHz, with one tick of certified delay and 20 ms of longest_gap_s.
struct AgedDevice {
  explicit AgedDevice(double neutral = 0.0) {
    g_now_ns = 1'000'000'000;
    DeviceModel model = desktopInARig();
    for (DeviceAxis& axis : model.axes) axis.neutral_effort = neutral;
    model.output_delay_ticks = 1;
    model.watch.longest_gap_s = 0.02;
    device = orThrow(
        PluginDevice::make(driver, model, 1e-3, std::nullopt, []() noexcept { return g_now_ns; }));
    orThrow(device->open());
    orThrow(device->enable());
  }
  Fault tick(std::int64_t age_ns) {
    g_now_ns += 1'000'000;
    driver->age_ns = age_ns;
    return device->read(reading, 1);
  }
  Fault tickWith(const AxisEffort& effort) {
    const Fault faults = tick(0);
    (void)device->write(effort);
    return faults;
  }
  std::shared_ptr<AgedDriver> driver = std::make_shared<AgedDriver>();
  std::unique_ptr<HapticDevice> device;
  DeviceReading reading;
};

// Rule of docs/safety.md: stops at once if a sample is older than longest_gap_s, and within 0.1 s
// if the mean age exceeds the certified delay plus one tick, here 2 ms.
TEST(SampleAge, AgeUpTo100Milliseconds_StopsByTheRuleOfTheSafetyDocument) {
  auto random = seededRandom(3404);
  for (int i = 0; i < cases(2000); ++i) {
    const double age_ms = uniform(random, 0.0, i % 2 == 0 ? 5.0 : 100.0);
    SCOPED_TRACE(age_ms);
    AgedDevice at;
    for (int k = 0; k < 200; ++k) (void)at.tick(0);
    Fault all = Fault::kNone;
    int stopped_after = -1;
    for (int k = 0; k < 1000; ++k) {
      all |= at.tick(static_cast<std::int64_t>(age_ms * 1e6));
      if (stopped_after < 0 && any(all & kStoppingFaults)) stopped_after = k;
    }
    EXPECT_EQ(any(all & Fault::kStaleSample), age_ms > 20.0);
    if (age_ms < 1.999) {
      EXPECT_EQ(all, Fault::kNone);
    } else if (age_ms > 2.5) {
      // An exponential mean with a time constant of 0.1 s exceeds 2 ms after −0.1 ln(1 − 2 / age)
      // s.
      const double within_ms = -100.0 * std::log(1.0 - 2.0 / age_ms);
      ASSERT_GE(stopped_after, 0);
      EXPECT_LE(stopped_after, within_ms + age_ms + 2.0);
    }
  }
}

TEST(SampleAge, FrozenTimeWithRisingSequence_StopsWithinLongestGap) {
  AgedDevice at;
  for (int k = 0; k < 100; ++k) EXPECT_EQ(at.tick(0), Fault::kNone);
  int good = 0;
  while (good < 100 && !any(at.tick(1'000'000 * (good + 1)) & kStoppingFaults)) ++good;
  EXPECT_LE(good, 20);
}

TEST(SampleAge, SampleFromTheFuture_Stops) {
  AgedDevice at;
  EXPECT_EQ(at.tick(0), Fault::kNone);
  EXPECT_TRUE(any(at.tick(-5'000'000) & Fault::kStaleSample));
}

// A good device: samples up to a period old, and now and then late by up to 15 ms.
TEST(SampleAge, SamplesOfAGoodDeviceWithJitter_NeverStop) {
  auto random = seededRandom(3405);
  AgedDevice at;
  for (int k = 0; k < cases(1'000'000); ++k) {
    const double age_ms =
        random() % 500 == 0 ? uniform(random, 0.0, 15.0) : uniform(random, 0.0, 1.0);
    ASSERT_EQ(at.tick(static_cast<std::int64_t>(age_ms * 1e6)), Fault::kNone) << k;
  }
}

// Rule of docs/safety.md: stops if three of the last seven samples are beyond the efforts sent by
// more than a tenth of the limit, a quarter of the sent effort and 2 e^-5 limits.
TEST(EffortAstray, WrongEffortOfADrive_StopsByTheRuleOfTheSafetyDocument) {
  const double limit = desktopInARig().axes[0].effort_limit;
  auto random = seededRandom(3406);
  for (int i = 0; i < cases(500); ++i) {
    AgedDevice at;
    at.driver->odd = static_cast<std::size_t>(i % 3);
    const double sent = uniform(random, -limit, limit);
    AxisEffort efforts(3);
    efforts[i % 3] = sent;
    for (int k = 0; k < 50; ++k) ASSERT_EQ(at.tickWith(efforts), Fault::kNone);
    at.driver->gain = i % 2 == 0 ? 1.0 : uniform(random, -1.0, 2.0);
    at.driver->bias = i % 2 == 0 ? uniform(random, -limit, limit) : 0.0;
    const bool derates = i % 5 == 0;
    at.driver->status = derates ? WH_DERATING : 0;
    const double given = at.driver->gain * sent + at.driver->bias;
    const double tolerance = (0.1 + 2.0 * std::exp(-5.0)) * limit;
    const double allowed = tolerance + 0.25 * std::abs(sent);
    // A derating drive may give anything from zero to the sent effort.
    const bool less = derates && given * sent <= sent * sent;
    const double apart = less && given * sent >= 0.0 ? 0.0
                         : less                      ? std::abs(given)
                                                     : std::abs(given - sent);
    const double most = less ? tolerance : allowed;
    SCOPED_TRACE(std::to_string(sent) + " sent, " + std::to_string(given) + " given");
    int stopped_after = -1;
    for (int k = 0; k < 300 && stopped_after < 0; ++k) {
      if (any(at.tickWith(efforts) & Fault::kEffortAstray)) stopped_after = k;
    }
    EXPECT_EQ(stopped_after, apart < most ? -1 : 2);
  }
}

/// A drive that oscillates at its limit, whatever was sent.
struct Oscillation {
  double per_sample, phase, sent;
};
int samplesUntilAstray(AgedDevice& at, int axis, const Oscillation& tested, int most) {
  const double limit = desktopInARig().axes[axis].effort_limit;
  AxisEffort efforts(3);
  efforts[axis] = tested.sent * limit;
  at.driver->odd = static_cast<std::size_t>(axis);
  for (int k = 0; k < 50; ++k) {
    if (any(at.tickWith(efforts))) return -1;
  }
  at.driver->gain = 0.0;
  for (int k = 0; k < most; ++k) {
    at.driver->bias =
        limit * std::sin(2.0 * std::numbers::pi * (tested.per_sample * k + tested.phase));
    if (any(at.tickWith(efforts) & Fault::kEffortAstray)) return k + 1;
  }
  return -1;
}

// From 1 Hz to 0.4 of the sample rate: ended within 0.3 s. Some frequencies are fractions of the
// sample rate, at which the same few phases return for ever.
TEST(EffortAstray, OscillationAtTheLimit_StopsWithin300Milliseconds) {
  auto random = seededRandom(3408);
  int latest = 0;
  for (int i = 0; i < cases(1500); ++i) {
    Oscillation tested{};
    const double fractions[] = {0.25, 1.0 / 3.0, 0.2, 0.4, 0.3};
    tested.per_sample = random() % 4 == 0 ? fractions[random() % 5]
                                          : 1e-3 * std::pow(400.0, uniform(random, 0.0, 1.0));
    tested.phase =
        random() % 2 == 0 ? static_cast<double>(random() % 24) / 24.0 : uniform(random, 0.0, 1.0);
    // Below 2 Hz an oscillation may stay near an effort that was sent for 0.3 s.
    const bool any_sent = tested.per_sample >= 2e-3 && random() % 2 == 0;
    tested.sent = any_sent ? uniform(random, -1.0, 1.0) : 0.0;
    AgedDevice at;
    const int samples = samplesUntilAstray(at, i % 3, tested, 300);
    ASSERT_GE(samples, 3) << tested.per_sample << " of the sample rate, phase " << tested.phase
                          << ", sent " << tested.sent;
    latest = std::max(latest, samples);
  }
  figure("oscillation at the limit: ended after at most", latest, "ms");
}

// Derating allows less, until the drive has recovered, and never more nor the other way.
TEST(EffortAstray, DeratingDrive_MayGiveLessAndNeverMore) {
  const double limit = desktopInARig().axes[0].effort_limit;
  for (const double sent : {0.6 * limit, -0.6 * limit}) {
    for (const double gain : {0.0, 0.5, 1.9, -0.6}) {
      AgedDevice at;
      AxisEffort efforts(3);
      efforts[0] = sent;
      for (int k = 0; k < 50; ++k) ASSERT_EQ(at.tickWith(efforts), Fault::kNone);
      at.driver->status = WH_DERATING;
      at.driver->gain = gain;
      Fault all = Fault::kNone;
      for (int k = 0; k < 100; ++k) all |= at.tickWith(efforts);
      EXPECT_EQ(any(all & Fault::kEffortAstray), gain > 1.0 || gain < 0.0) << gain;
      if (gain > 1.0 || gain < 0.0) continue;
      at.driver->status = 0;
      for (int k = 0; k < 8; ++k) {  // recovers with a time constant of 2 ms
        at.driver->gain = 1.0 - (1.0 - gain) * std::exp(-0.5 * (k + 1));
        ASSERT_EQ(at.tickWith(efforts), Fault::kNone) << "while it recovers, " << k;
      }
      at.driver->gain = gain;
      all = Fault::kNone;
      for (int k = 0; k < 20; ++k) all |= at.tickWith(efforts);
      EXPECT_TRUE(any(all & Fault::kEffortAstray)) << "it no longer says that it derates";
    }
  }
}

// One of several drives derates, as in a composite: the others are judged in full.
TEST(EffortAstray, AxisBesideADeratingOne_MayNotGiveLess) {
  const double limit = desktopInARig().axes[0].effort_limit;
  for (std::size_t derating = 0; derating < 3; ++derating) {
    for (std::size_t odd = 0; odd < 3; ++odd) {
      AgedDevice at;
      const AxisEffort efforts(3, 0.6 * limit);
      at.driver->odd = odd;
      at.driver->status = WH_DERATING;
      at.driver->derating = 1U << derating;
      for (int k = 0; k < 50; ++k) {
        ASSERT_FALSE(any(at.tickWith(efforts) & Fault::kEffortAstray)) << k;
      }
      at.driver->gain = 0.3;
      Fault all = Fault::kNone;
      for (int k = 0; k < 20; ++k) all |= at.tickWith(efforts);
      EXPECT_EQ(any(all & Fault::kEffortAstray), odd != derating) << odd << " of " << derating;
    }
  }
}

TEST(EffortAstray, EffortAtRestBeyondNeutral_RefusesArming) {
  for (const double neutral : {0.0, 1.6, -1.6}) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double way : {1.0, -1.0}) {
        // A drive may still be on its way from zero to the neutral effort.
        const double end = way * neutral > 0.0 ? neutral : 0.0;
        const double beyond = 0.8 + 16.0 * std::exp(-5.0) + 0.25 * std::abs(end);
        for (const double share : {0.99, 1.01}) {
          AgedDevice at(neutral);
          at.device->close();
          at.driver->odd = static_cast<std::size_t>(axis);
          at.driver->gain = 0.0;
          at.driver->bias = end + way * share * beyond;
          ASSERT_TRUE(at.device->open());
          const Expected<Done> enabled = at.device->enable();
          EXPECT_EQ(enabled.ok(), share < 1.0) << neutral << ", " << at.driver->bias;
          EXPECT_EQ(at.driver->enabled.load(), share < 1.0) << "undone";
          if (!enabled) {
            EXPECT_EQ(enabled.errors().front().value, at.driver->axes()[axis].name);
          }
        }
      }
    }
  }
}

// The device has a gripper that the file does not list. It keeps what it gave at arming.
TEST(EffortAstray, UnlistedAxis_StopsWhenItsEffortChangedSinceArming) {
  for (const double at_arming : {0.0, 5.0, -5.0}) {
    for (const double change : {0.79, -0.79, 0.81, -0.81, 8.0}) {
      AgedDevice at;
      at.device->close();
      at.driver->unlisted = at_arming;
      ASSERT_TRUE(at.device->open());
      ASSERT_TRUE(at.device->enable());
      AxisEffort efforts(3, 2.0);
      for (int k = 0; k < 50; ++k) ASSERT_EQ(at.tickWith(efforts), Fault::kNone);
      at.driver->unlisted = at_arming + change;  // a tenth of its limit is 0.8 N
      int stopped_after = -1;
      for (int k = 0; k < 300 && stopped_after < 0; ++k) {
        if (any(at.tickWith(efforts) & Fault::kEffortAstray)) stopped_after = k;
      }
      EXPECT_EQ(stopped_after, std::abs(change) > 0.8 ? 2 : -1) << at_arming << " " << change;
    }
  }
}

TEST(EffortAstray, TwoBadSamplesOfSeven_NeverStopAndThreeDo) {
  for (unsigned pattern = 0; pattern < 128; ++pattern) {
    AgedDevice at;
    bool stopped = false;
    for (int k = 0; k < 50; ++k) (void)at.tickWith(AxisEffort(3));
    for (int k = 0; k < 14; ++k) {
      at.driver->bias = k < 7 && (pattern >> k & 1U) != 0 ? 8.0 : 0.0;
      stopped = any(at.tickWith(AxisEffort(3)) & Fault::kEffortAstray) || stopped;
    }
    EXPECT_EQ(stopped, std::popcount(pattern) >= 3) << pattern;
  }
}

// A drive that holds the last accepted effort is not astray.
TEST(EffortAstray, RefusedWrite_IsJudgedByTheEffortThatTheDriveHolds) {
  AgedDevice at;
  AxisEffort efforts(3, 4.0);
  for (int k = 0; k < 50; ++k) ASSERT_EQ(at.tickWith(efforts), Fault::kNone);
  at.driver->refuses = true;
  for (int k = 0; k < 50; ++k) {
    efforts = AxisEffort(3, -8.0);
    ASSERT_EQ(at.tickWith(efforts), Fault::kNone) << k;
  }
}

TEST(EffortAstray, DriveWithoutMeasuredEffort_NeverStops) {
  AgedDevice at;
  at.driver->bias = std::nan("");
  AxisEffort efforts(3);
  efforts[0] = desktopInARig().axes[0].effort_limit;
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(at.tickWith(efforts), Fault::kNone);
}

// Efforts change as fast as the slew limit allows; they act up to 5 ticks late, within 5 % and with
// noise.
TEST(EffortAstray, EffortsOfAGoodDevice_NeverStop) {
  const double limit = desktopInARig().axes[0].effort_limit;
  auto random = seededRandom(3407);
  AgedDevice at;
  AxisEffort efforts(3), aims(3);
  for (int k = 0; k < cases(200'000); ++k) {
    for (int a = 0; a < 3; ++a) {
      if (random() % 20 == 0) aims[a] = uniform(random, -limit, limit);
      efforts[a] += std::clamp(aims[a] - efforts[a], -0.25 * limit, 0.25 * limit);
    }
    if (random() % 1000 == 0) at.driver->late = random() % 6;
    at.driver->gain = uniform(random, 0.95, 1.05);
    at.driver->bias = uniform(random, -0.1, 0.1) * limit;
    at.driver->odd = random() % 3;
    ASSERT_EQ(at.tickWith(efforts), Fault::kNone) << k;
  }
}

}  // namespace
}  // namespace wholehand::test
