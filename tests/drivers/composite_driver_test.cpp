// The driver `composite` from its file, with two faulty drivers (tests/devices/faulty_driver.c) and
// with two frames.
#include "devices/plugin/plugin_device.hpp"
#include "devices/plugin/plugin_driver.hpp"
#include "firmware_process.hpp"
#include "loop/fault_injection/pushing_exercise.hpp"
#include "support/contains.hpp"
#include "support/folder.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::test {
namespace {

namespace fs = std::filesystem;

std::string driverPath(const std::string& name) {
  return std::string(WHOLEHAND_BINARY_DIR) + "/drivers/" + name + ".so";
}

DeviceModel desktopOnARig() {
  return load(shippedFiles("desktop-3axis", "empty", "adult-median-right", "no-arm")).device;
}

// Loads the driver from its file.
class CompositeDriver : public testing::Test {
 protected:
  CompositeDriver() : path_(folder_.file("pair.toml")) {}
  // The base has x and y, the hand z, with the axes of the desktop device.
  std::string file(const std::string& base, const std::string& hand,
                   const std::string& hand_driver = "faulty") {
    std::ofstream(path_) << "kind = \"composite\"\nversion = 1\nlongest_skew_s = 0.005\n"
                         << "[[parts]]\ndriver = \"" << driverPath("faulty") << "\"\nsettings = \""
                         << base << "\"\naxes = [\"x\", \"y\"]\n"
                         << "[[parts]]\ndriver = \"" << driverPath(hand_driver)
                         << "\"\nsettings = \"" << hand << "\"\naxes = [\"z\"]\n";
    return path_.string();
  }
  Expected<std::shared_ptr<PluginDriver>> open(const std::string& file,
                                               CalledBy called_by = CalledBy::kLoop) {
    return PluginDriver::load({"composite", "", file}, nullptr, called_by);
  }
  std::string refusal(const std::string& text) {
    std::ofstream(path_) << text;
    const auto driver = open(path_.string());
    return driver ? "" : format(driver.errors());
  }

  Folder folder_;
  fs::path path_;
};

TEST_F(CompositeDriver, PartThatMayWait_IsRefusedForALoopAndAcceptedForAHost) {
  const auto refused = open(file("well", "well", "may_wait"));
  EXPECT_TRUE(refusedWith(refused, "WH_NEVER_WAITS"));
  EXPECT_TRUE(open(file("well", "well", "may_wait"), CalledBy::kHost));
  EXPECT_TRUE(open(file("well", "well"))) << "both never wait";
}

// A passport also covers the files that the parts' settings name.
TEST_F(CompositeDriver, ChangedFileNamedByAPartsSettings_ChangesTheIdentity) {
  for (const char* name : {"ab", "a b", "a=b"}) {
    fs::create_directory(folder_.file(name));
    const std::string map = folder_.file(std::string(name) + "/map.toml");
    const auto sdk = [&](const char* text) {
      std::ofstream(map) << text;
      return orThrow(open(file("gear=1", map)))->identity().sdk;
    };
    const std::string first = sdk("sign = 1");
    EXPECT_EQ(sdk("sign = 1"), first);
    EXPECT_NE(sdk("sign = -1"), first) << map;
  }
}

TEST_F(CompositeDriver, InvalidFile_IsRefusedByName) {
  const std::string head = "kind = \"composite\"\nversion = 1\nlongest_skew_s = 0.005\n";
  const auto part = [](const std::string& driver, const std::string& axes) {
    return "[[parts]]\ndriver = \"" + driver + "\"\naxes = [" + axes + "]\n";
  };
  const std::string good = part(driverPath("faulty"), "\"x\"");
  const struct {
    std::string text, expected;
  } cases[] = {
      {head + good, "parts"},
      {head + good + good, "gives x a second time"},
      {head + good + part(driverPath("faulty"), "\"w\""), "w: "},
      {head + good + part("no-such", "\"y\""), "no-such"},
      {head + good + part(driverPath("faulty"), "\"y\"") + good, "third part"},
      {"kind = \"composite\"\nversion = 1\nlongest_skew_s = 0.0\n" + good + good, "longest_skew_s"},
      {head + "skew = 1\n" + good + part(driverPath("faulty"), "\"y\""), "skew"}};
  for (const auto& one : cases) {
    const std::string said = refusal(one.text);
    EXPECT_TRUE(contains(said, one.expected));
  }
  const auto nowhere = PluginDriver::load({"composite", "", ""});
  EXPECT_TRUE(refusedWith(nowhere, "--driver-settings FILE"));
}

struct Lost {
  const char* name;
  bool hand;  ///< true: the hand fails; false: the base fails
};

class LostPart : public CompositeDriver, public testing::WithParamInterface<Lost> {};

// In a whole rig with an exercise that pushes, one part fails, and both parts must ramp to neutral.
TEST_P(LostPart, LossOfOnePart_RampsBothToNeutralWithin100ms) {
  seesRealTime();  // a skew of more than 5 ms between the parts is a fault, too
  const std::string faulty = std::string(GetParam().name) + "@300";
  auto driver = orThrow(open(GetParam().hand ? file("well", faulty) : file(faulty, "well")));
  Models models = load(shippedFiles("desktop-3axis", "empty", "adult-median-right", "no-arm"));
  AxisEffort limit(3, 8.0);
  models.exercise = std::make_unique<PushingExercise>(limit, Push::kWell, 0, 0);
  auto device = orThrow(PluginDevice::make(driver, models.device, 1e-3));
  auto rig = orThrow(buildRigWithoutPerson(std::move(models), std::move(device), {}));
  ASSERT_TRUE(rig->renderer->arm());
  TickRecord record;
  int fault = -1, neutral = -1;
  std::array<double, 3> before{};
  double pushed = 0.0;
  // Ticks follow without waiting; a frozen part is found once its sample is too old.
  for (int tick = 0; tick < 20'000 && neutral < 0; ++tick) {
    record.tick = static_cast<std::uint64_t>(tick);
    record.time_s = tick * 1e-3;
    record.command_count = 0;
    rig->renderer->tick(1, record);
    if (fault < 0 && any(record.faults & kStoppingFaults)) fault = tick;
    for (int a = 0; a < 3; ++a) {
      const double now = record.sent[a];
      const double was = std::exchange(before[a], now);
      if (fault < 0) pushed = std::max(pushed, std::abs(now));
      if (fault >= 0 && tick > fault) {
        EXPECT_LE(std::abs(now), std::abs(was) + 1e-12) << kAlways;
      }
    }
    if (rig->renderer->finished()) neutral = tick;
  }
  ASSERT_GE(fault, 0);
  ASSERT_GE(neutral, 0);
  EXPECT_GT(pushed, 0.5) << "nothing was pushed: the test proves nothing";
  EXPECT_FALSE(any(record.faults & Fault::kDeviceWrite));
  EXPECT_LE(neutral - fault, 100) << kAlways;
  // The effort that the healthy part really holds; the faulty driver reports its command as
  // measured.
  wh_sample sample{};
  sample.size = sizeof(sample);
  ASSERT_GE(driver->read(sample), 0);
  for (std::size_t i = 0; i < 3; ++i) {
    const bool hands = i == 2;
    if (hands != GetParam().hand) {
      EXPECT_EQ(sample.effort[i], 0.0) << kAlways << "axis " << i;
    }
  }
}
const std::vector<Lost> kLost = {{"unplug", true},  {"unplug", false},    {"refuse", true},
                                 {"refuse", false}, {"frozen", true},     {"frozen", false},
                                 {"clock", true},   {"backwards", false}, {"silenced", true},
                                 {"drive", false}};
INSTANTIATE_TEST_SUITE_P(Kinds, LostPart, testing::ValuesIn(sampleTenth(kLost)),
                         [](const auto& tested) {
                           return std::string(tested.param.name) +
                                  (tested.param.hand ? "_hand" : "_base");
                         });

// One frame over shared memory and another over UDP, loaded by names and file alone.
TEST(CompositeOfFrames, TwoFrames_RenderOverTwoCarriers) {
  const FirmwareProcess base("udp:0"), hand("shm:pair-" + std::to_string(::getpid()));
  const Folder folder;
  const fs::path path = folder.file("pair.toml");
  std::ofstream(path) << "kind = \"composite\"\nversion = 1\nlongest_skew_s = 1.0\n"
                      << "[[parts]]\ndriver = \"frame\"\ndevice_at = \"" << base.locator()
                      << "\"\naxes = [\"x\", \"y\"]\n[[parts]]\ndriver = \"frame\"\ndevice_at = \""
                      << hand.locator() << "\"\naxes = [\"z\"]\n";
  std::vector<std::string> said;
  {
    const auto driver = orThrow(PluginDriver::load(
        {"composite", "", path.string()}, [&](const std::string& line) { said.push_back(line); }));
    const auto device = orThrow(PluginDevice::make(driver, desktopOnARig(), 1e-3));
    ASSERT_TRUE(device->open());
    ASSERT_TRUE(device->ready());
    ASSERT_TRUE(device->enable());
    DeviceReading reading;
    for (int i = 0; i < 200; ++i) {
      ASSERT_EQ(device->write(AxisEffort(3, 1.0)), Fault::kNone);
      (void)device->read(reading, 1);
      ::usleep(1000);
    }
    EXPECT_GT(reading.q_m[0], 1e-4);
    EXPECT_GT(reading.q_m[2], 1e-4);
    device->close();
  }
  ASSERT_FALSE(said.empty());
  EXPECT_NE(said.back().find("largest skew between the two samples"), std::string::npos);
}

}  // namespace
}  // namespace wholehand::test
