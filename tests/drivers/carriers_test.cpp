// The driver `frame` and the reference firmware as processes, over each carrier.
#include "devices/plugin/plugin_device.hpp"
#include "devices/plugin/plugin_driver.hpp"
#include "files/device/device_file.hpp"
#include "firmware_process.hpp"
#include "frame_bench.hpp"
#include "loop/model/device_model.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "support/contains.hpp"
#include "support/open_enabled.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fcntl.h>
#include <thread>
#include <unistd.h>

namespace wholehand::test {
namespace {

std::int64_t waitAMillisecond() {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return monotonicNow_ns();
}

DeviceModel frameModel() {
  return orThrow(
      loadDeviceFile(std::string(WHOLEHAND_SOURCE_DIR) + "/config/devices/desktop-3axis.toml"));
}

std::shared_ptr<PluginDriver> frameAt(const std::string& locator) {
  return orThrow(PluginDriver::load({"frame", locator, ""}));
}

// Positions after each of several commands, one millisecond of the firmware's clock apart.
std::vector<double> positionsOver(const std::string& where) {
  const FirmwareProcess firmware(where, true);
  const auto device =
      orThrow(FrameDevice::open(orThrow(openCarrier(firmware.locator())), 77, &waitAMillisecond));
  (void)orThrow(device->control(WH_ENABLE, 0.0, &waitAMillisecond));
  std::vector<double> positions;
  std::int64_t pumped_ns = monotonicNow_ns(),
               longest_ns = 0;  // longest time between two reads of the line
  for (int k = 1; k <= 100; ++k) {
    const double effort = std::sin(0.3 * k) * 5.0;
    EXPECT_EQ(device->write(commandOf({effort, -effort, 0.5 * effort})), WH_OK);
    wh_sample sample = emptySample();
    const std::int64_t until_ns = monotonicNow_ns() + 300'000'000'000;
    // The sample after the command reports its effort.
    while (sample.effort[0] != static_cast<double>(static_cast<float>(effort))) {
      const std::int64_t now_ns = monotonicNow_ns();
      longest_ns = std::max(longest_ns, now_ns - pumped_ns);
      pumped_ns = now_ns;
      device->pump(now_ns);
      EXPECT_GE(device->read(sample), 0);
      if (now_ns > until_ns) {
        ADD_FAILURE() << where << " lost command " << k;
        return positions;
      }
      std::this_thread::yield();
    }
    positions.insert(positions.end(), sample.position, sample.position + 3);
  }
  // A line holds a few kilobytes, some 50 ms of samples. If a busy machine kept this test from
  // reading for so long, samples were lost, and only the positions are judged.
  const FrameCounters counted = device->counters();
  if (longest_ns < 30'000'000) {
    EXPECT_EQ(counted.broken + counted.crc_errors + counted.foreign + counted.stale, 0U) << where;
  }
  return positions;
}

// Two programs on one line or segment would take each other's bytes; a device on UDP distinguishes
// sessions.
TEST(Carriers, LineOrSegmentInUse_IsRefusedToASecondProgram) {
  for (const std::string& where : everyCarrier()) {
    if (where.rfind("udp", 0) == 0) continue;
    const FirmwareProcess firmware(where);
    auto first = openCarrier(firmware.locator());
    ASSERT_TRUE(first) << where;
    const auto second = openCarrier(firmware.locator());
    EXPECT_TRUE(refusedWith(second, "is held by another program"));
    first->reset();
    EXPECT_TRUE(openCarrier(firmware.locator())) << where << ": its owner is gone";
  }
}

TEST(Carriers, SameCommands_GiveTheSameSamplesOverEveryCarrier) {
  std::vector<double> first;
  for (const std::string& where : everyCarrier()) {
    const std::vector<double> positions = positionsOver(where);
    ASSERT_EQ(positions.size(), 300U) << where;
    if (first.empty()) first = positions;
    EXPECT_EQ(positions, first) << where;
  }
  EXPECT_GT(std::abs(first[298]), 1e-4) << "nothing moved";
}

// Takes the same steps as `run --driver frame`: loads the driver by its name and compares it with a
// device file.
TEST(Carriers, DriverByItsName_FitsTheDesktopFileAndRendersOverEveryCarrier) {
  for (const std::string& where : everyCarrier()) {
    FirmwareProcess firmware(where);
    const auto device =
        orThrow(PluginDevice::make(frameAt(firmware.locator()), frameModel(), 1e-3));
    ASSERT_TRUE(openEnabled(*device)) << where;
    ASSERT_TRUE(device->ready());
    DeviceReading reading;
    int good = 0, bad = 0;
    for (int i = 0; i < 20'000 && good < 100; ++i) {
      ASSERT_EQ(device->write(AxisEffort(3, 1.0)), Fault::kNone);
      // The machine may stall this test for longer than a sample may be old or the firmware waits;
      // the device then stays at neutral until it is opened again.
      const bool is_good = !any(device->read(reading, 1));
      good += is_good ? 1 : 0;
      bad = is_good ? 0 : bad + 1;
      if (bad == 1000) {
        device->close();
        ASSERT_TRUE(openEnabled(*device)) << where;
        bad = 0;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(good, 100) << where;
    EXPECT_GT(reading.q_m[0], 1e-4) << where << ": 1 N for 0.1 s and more moves 0.25 kg";
    device->close();
    const PhaseLine off = firmware.until("off");
    EXPECT_EQ(off.phase, "off") << where;
    EXPECT_EQ(off.most_effort, 0.0);
  }
}

TEST(Carriers, SerialLineUnpluggedWhileInUse_FaultsReadAndWrite) {
  FirmwareProcess firmware("serial");
  const auto device = orThrow(PluginDevice::make(frameAt(firmware.locator()), frameModel(), 1e-3));
  ASSERT_TRUE(openEnabled(*device));
  DeviceReading reading;
  ASSERT_EQ(device->write(AxisEffort(3, 1.0)), Fault::kNone);
  ASSERT_EQ(device->read(reading, 1), Fault::kNone);
  firmware.send(SIGKILL);
  firmware.wait();
  Fault read = Fault::kNone, written = Fault::kNone;
  for (int i = 0; i < 5000 && !(any(read & Fault::kDeviceRead) && any(written)); ++i) {
    read = device->read(reading, 1);
    written = device->write(AxisEffort(3, 1.0));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(any(read & Fault::kDeviceRead));
  EXPECT_TRUE(any(written & Fault::kDeviceWrite));
  device->close();
  EXPECT_FALSE(openEnabled(*device)) << "it is gone";
}

// The pseudo-terminal acts as a cable that is pulled out between two bytes of a frame.
TEST(SerialCarrier, LineClosedInMidFrame_GivesTheReceivedBytesAndThenFails) {
  const int cable = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(cable, 0);
  ASSERT_EQ(::grantpt(cable), 0);
  ASSERT_EQ(::unlockpt(cable), 0);
  const auto carrier = orThrow(openCarrier(std::string("serial:") + ::ptsname(cable) + ":115200"));
  std::array<std::uint8_t, 64> bytes{};
  EXPECT_EQ(carrier->receive(bytes.data(), bytes.size()), 0) << "nothing yet is not gone";
  const std::array<std::uint8_t, 3> half = {0, 5, 0x11};
  ASSERT_EQ(::write(cable, half.data(), half.size()), 3);
  EXPECT_TRUE(carrier->send(half.data(), half.size()));
  ASSERT_EQ(carrier->receive(bytes.data(), bytes.size()), 3)
      << "raw: no byte is turned into another";
  EXPECT_EQ(bytes[1], 5);
  ASSERT_EQ(::write(cable, half.data(), half.size()), 3);
  ::close(cable);
  int count = 0;
  for (int i = 0; i < 3 && count >= 0; ++i) count = carrier->receive(bytes.data(), bytes.size());
  EXPECT_EQ(count, -1);
  EXPECT_FALSE(carrier->send(half.data(), half.size()));
}

// UDP and shared memory do not tell that the sender is dead; only the samples are frozen. The limit
// is 20 ms, that is 20 ticks of 1 ms.
TEST(Carriers, DeviceLostOnUdpOrMemory_IsAStaleSample) {
  for (const std::string& where : {everyCarrier()[0], everyCarrier()[2]}) {
    FirmwareProcess firmware(where);
    const auto device =
        orThrow(PluginDevice::make(frameAt(firmware.locator()), frameModel(), 1e-3));
    ASSERT_TRUE(openEnabled(*device));
    firmware.send(SIGKILL);
    firmware.wait();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    DeviceReading reading;
    Fault faults = Fault::kNone;
    int ticks = 0;
    for (; ticks < 100 && !any(faults & Fault::kStaleSample); ++ticks) {
      faults = device->read(reading, 1);
    }
    EXPECT_LE(ticks, 25) << where;
    EXPECT_TRUE(any(faults & Fault::kStaleSample));
    ::unlink(("/dev/shm/wholehand-frame-test-" + std::to_string(::getpid())).c_str());
  }
}

TEST(FrameDriver, Settings_AreRefusedByName) {
  const auto driver = PluginDriver::load({"frame", "udp:127.0.0.1:1", "fast=1"});
  EXPECT_TRUE(refusedWith(driver, "has no settings"));
}

}  // namespace
}  // namespace wholehand::test
