// A device host and its loop over shared memory.
#include "devices/plain_driver.hpp"
#include "faulty_places.hpp"
#include "hosted_tools.hpp"
#include "loop/core/compiler.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "loop/realtime/system_call_counter.hpp"
#include "support/contains.hpp"
#include "support/open_enabled.hpp"

#include <gtest/gtest.h>

namespace wholehand::test {
namespace {

// Arms again if the machine stalled the test and the host latched; the test is not about this.
void armAnewWhereLatched(HostThread& host, HapticDevice& device) {
  if (host.sample().phase != HostPhase::kLatched) return;
  device.close();
  ASSERT_TRUE(openEnabled(device));
}

/// A driver with the axes of the faulty driver, of another maker, without a serial number.
class CarryingDriver final : public PlainDriver {
 public:
  explicit CarryingDriver(std::vector<wh_axis> axes)
      : PlainDriver({}, {}), axes_(std::move(axes)) {}
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  [[nodiscard]] bool enablesAtNeutral() const noexcept override { return true; }
  [[nodiscard]] int read(wh_sample& sample) noexcept override {
    sample.sequence = ++samples_;
    sample.monotonic_ns = monotonicNow_ns();
    sample.status = status;
    return WH_OK;
  }
  [[nodiscard]] int write(const wh_command&) noexcept override { return WH_OK; }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double) override {
    if (verb == WH_ENABLE) ++enabled_times;
    return Done{};
  }

  std::atomic<std::uint32_t> status{0};
  std::atomic<int> enabled_times{0};

 private:
  std::vector<wh_axis> axes_;
  std::uint64_t samples_ = 0;
};

TEST(HostedDevice, AxesInAnotherOrder_AreMappedToTheFilesOrder) {
  const std::string name = hostName("order");
  const auto driver = faultyDriver("");
  HostThread host(name, driver, desktop());
  const auto hosted = orThrow(HostedDriver::connect(name));
  EXPECT_EQ(hosted->name(), "faulty");
  EXPECT_EQ(hosted->identity().serial, "S-1");
  EXPECT_EQ(hosted->identity().sdk, "7");
  const auto device = deviceOf(hosted);
  ASSERT_NO_FATAL_FAILURE(expectPlacesOfFaultyDriver(*device));
  ASSERT_TRUE(device->enable());
  // The driver reports the commanded effort as measured.
  bool given = false;
  for (int i = 0; i < 2000 && !given; ++i) {
    armAnewWhereLatched(host, *device);
    ASSERT_EQ(device->write(efforts(0.5, -0.25, 2.0)), Fault::kNone);
    const wh_sample sample = host.sample().sample;
    given = sample.effort[3] == 0.5 && sample.effort[2] == -0.25 && sample.effort[0] == 2.0 &&
            sample.effort[1] == 0.0;
    sleepMs(1);
  }
  EXPECT_TRUE(given);
  device->close();
  DeviceReading reading;
  EXPECT_EQ(device->read(reading, 1), Fault::kDeviceRead) << "closed";
  for (int i = 0; i < 2000 && (host.sample().sample.status & WH_ENABLED) != 0; ++i) sleepMs(1);
  EXPECT_EQ(host.sample().sample.status & WH_ENABLED, 0U);
}

// The pages of `run --host` show this (docs/device-host.md).
TEST(HostedDevice, BetweenSessions_FactsAreWhatTheDriveSaysNow) {
  const std::string name = hostName("between");
  DeviceModel model = desktop();
  model.axes[0].neutral_effort = 0.5;  // weighs something, so that it is held between sessions
  const auto driver = std::make_shared<CarryingDriver>(faultyDriver("")->axes());
  driver->status = WH_HOMED | WH_ENABLED;
  HostThread host(name, driver, model);
  const auto hosted = orThrow(HostedDriver::connect(name));
  const auto comes_to = [&](DriveState drive) {
    for (int i = 0; i < 300'000; ++i, sleepMs(1)) {
      if (hosted->facts().drive == drive && !hosted->inSession()) return true;
    }
    return false;
  };
  EXPECT_TRUE(comes_to(DriveState::kOn)) << "before the first session";
  ASSERT_TRUE(hosted->control(WH_ENABLE, 0.0));
  EXPECT_TRUE(hosted->inSession());
  ASSERT_TRUE(hosted->control(WH_DISABLE, 0.0));
  ASSERT_TRUE(comes_to(DriveState::kOn));
  driver->status = WH_HOMED;
  ASSERT_TRUE(comes_to(DriveState::kOff));
  const HostFacts now = hosted->facts();
  EXPECT_TRUE(now.held);
  EXPECT_EQ(now.status, WH_HOMED);
  EXPECT_GE(now.drive_heard_s, 0.0);
  EXPECT_GE(now.drive_since_s, 0.0);
  driver->status = WH_HOMED | WH_ENABLED;
  EXPECT_TRUE(comes_to(DriveState::kOn));
  EXPECT_EQ(driver->enabled_times, 1) << "only by the loop's request";
}

TEST(HostedDevice, DelayOfTheHost_IsComparedWithTheFile) {
  const std::string name = hostName("delay");
  HostThread host(name, faultyDriver(""), desktop(), 1000.0);
  const auto hosted = orThrow(HostedDriver::connect(name));
  // The delay is 1 ms of the driver and two cycles of 1 ms; the file states 2 ms.
  const auto device = PluginDevice::make(hosted, desktop(), 1e-3);
  EXPECT_TRUE(refusedWith(device, "has a delay of 0.003, the file states 0.002"));
}

TEST(HostedDevice, NeutralEffortOtherThanTheHosts_IsRefusedWithTheAxis) {
  const std::string name = hostName("neutral");
  HostThread host(name, faultyDriver(""), desktop());
  const auto hosted = orThrow(HostedDriver::connect(name));
  EXPECT_TRUE(hosted->differences(desktop()).empty());
  DeviceModel other = desktop();
  other.axes[2].neutral_effort = 1.0;
  const Diagnostics said = hosted->differences(other);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said.front().value, "z");
}

// The armed device must be the checked one; the host's name alone does not prove it.
TEST(HostedDevice, HostRestartedWithAnotherDevice_IsDetectedBeforeEnabling) {
  const std::string name = hostName("again");
  const auto first = faultyDriver("");
  auto host = std::make_unique<HostThread>(name, first, desktop());
  const auto hosted = orThrow(HostedDriver::connect(name));
  const std::string serial = hosted->identity().serial, digest = hosted->identity().driver_sha256;
  EXPECT_EQ(digest.size(), 64U);
  host.reset();
  EXPECT_FALSE(openEnabled(*deviceOf(hosted))) << "nobody looked at what comes";
  DeviceModel other = desktop();
  other.axes[2].neutral_effort = 1.5;
  other.axes[2].effort_limit = 2.0;
  HostThread second(name, std::make_shared<CarryingDriver>(first->axes()), other);
  const auto again = hosted->reconnect();
  ASSERT_TRUE(again) << format(
      again.errors());  // the process of the first host is this one and still runs
  EXPECT_NE(hosted->identity().serial, serial);
  EXPECT_NE(hosted->identity().driver_sha256, digest);
  const Diagnostics said = hosted->differences(desktop());
  ASSERT_EQ(said.size(), 2U) << format(said);
  EXPECT_TRUE(contains(said[0].problem, "neutral effort"));
  EXPECT_TRUE(contains(said[1].problem, "effort limit"));
}

TEST(HostedDevice, DriverThatMayWait_IsAcceptedOnlyByTheHost) {
  EXPECT_FALSE(PluginDriver::load({built("may_wait"), "", ""}));
  const std::string name = hostName("waits");
  HostThread host(name, faultyDriver("", "may_wait"), desktop());
  EXPECT_TRUE(openEnabled(*deviceOf(orThrow(HostedDriver::connect(name)))));
}

TEST(HostedDevice, ReadsAndWrites_AllocateNothingMakeNoSystemCallAndTakeAMicrosecond) {
  const std::string name = hostName("cost");
  HostThread host(name, faultyDriver(""), desktop());
  const auto device = deviceOf(orThrow(HostedDriver::connect(name)));
  ASSERT_TRUE(openEnabled(*device));
  DeviceReading reading;
  const AxisEffort effort = efforts(1.0, 2.0, 3.0);
  ASSERT_EQ(device->read(reading, 1), Fault::kNone);
  constexpr int kTicks = 20'000;
  std::vector<double> cost_ns;
  for (int batch = 0; batch < 50; ++batch) {
    const std::int64_t begun_ns = threadCpuNow_ns();
    for (int i = 0; i < kTicks / 50; ++i) {
      (void)device->read(reading, 1);
      (void)device->write(effort);
    }
    cost_ns.push_back(static_cast<double>(threadCpuNow_ns() - begun_ns) / (kTicks / 50.0));
  }
  std::sort(cost_ns.begin(), cost_ns.end());
  figure("device host in the tick, CPU time of a read and a write, p50", cost_ns[25] * 1e-3, "us");
#if defined(__OPTIMIZE__) && !WHOLEHAND_SANITIZED
  EXPECT_LE(cost_ns[25], 1000.0);
#endif
  const std::uint64_t before = threadAllocations();
  const std::string why = watchSystemCalls();
  const std::uint64_t calls = threadSystemCalls();
  countSystemCalls(true);
  for (int i = 0; i < 1000; ++i) {
    (void)device->read(reading, 1);
    (void)device->write(effort);
  }
  countSystemCalls(false);
  EXPECT_EQ(threadAllocations(), before);
  if (why.empty()) {
    EXPECT_EQ(threadSystemCalls(), calls);
  } else {
    std::printf("system calls are not counted: %s\n", why.c_str());
  }
}

TEST(HostedDevice, LoopThatStoppedForAWhile_IsDisabledUntilItArmsAgain) {
  const std::string name = hostName("latch");
  HostThread host(name, faultyDriver(""), desktop());
  const auto device = deviceOf(orThrow(HostedDriver::connect(name)));
  ASSERT_TRUE(openEnabled(*device));
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(device->write(efforts(3.0, 0.0, 0.0)), Fault::kNone);
    sleepMs(1);
  }
  ASSERT_TRUE(host.awaits(HostPhase::kLatched));
  EXPECT_EQ(host.sample().reason, ReleaseReason::kLoopSilent);
  // In a cycle, the sample is read before the effort is written.
  for (int i = 0; i < 60'000 && host.sample().sample.effort[3] != 0.0; ++i) sleepMs(1);
  DeviceReading reading;
  for (int i = 0; i < 50; ++i) {
    (void)device->write(efforts(3.0, 0.0, 0.0));
    EXPECT_TRUE(any(device->read(reading, 1) & Fault::kEnableLost));
    EXPECT_EQ(host.sample().sample.effort[3], 0.0) << "nothing comes back";
    sleepMs(1);
  }
  device->close();
  ASSERT_TRUE(openEnabled(*device));
  EXPECT_EQ(device->read(reading, 1), Fault::kNone);
  EXPECT_EQ(host.sample().phase, HostPhase::kWaiting);
  bool heard = false;
  for (int i = 0; i < 60'000 && !heard; ++i) {
    armAnewWhereLatched(host, *device);
    EXPECT_EQ(device->write(efforts(1.0, 0.0, 0.0)), Fault::kNone);
    heard = host.sample().sample.effort[3] == 1.0;
    sleepMs(1);
  }
  EXPECT_TRUE(heard);
}

TEST(HostedDevice, HostAskedToEnd_GoesToNeutralFirst) {
  const std::string name = hostName("ends");
  const auto driver = faultyDriver("");
  HostThread host(name, driver, desktop());
  const auto device = deviceOf(orThrow(HostedDriver::connect(name)));
  ASSERT_TRUE(openEnabled(*device));
  std::atomic<bool> over{false};
  std::thread loop([&] {
    const AsUrgentAsALoop urgent;
    while (!over.load()) {
      (void)device->write(efforts(4.0, 0.0, 0.0));
      sleepMs(1);
    }
  });
  EXPECT_TRUE(host.awaits(HostPhase::kRendering));
  host.end();
  over.store(true);
  loop.join();
  const std::vector<HostEvent> events = host.events();
  const auto ramps = std::find_if(events.begin(), events.end(), [](const HostEvent& e) {
    return e.phase == HostPhase::kRamping;
  });
  ASSERT_NE(ramps, events.end());
  EXPECT_EQ(ramps->reason, ReleaseReason::kHostEnds);
  wh_sample sample{};
  ASSERT_GE(driver->read(sample), 0);
  EXPECT_EQ(sample.status & WH_ENABLED, 0U);
  EXPECT_EQ(sample.effort[3], 0.0);
}

/// Pushes along x until the effort is measured.
void pushUntilMeasured(HostThread& host, HapticDevice& device, double effort_n) {
  for (int i = 0; i < 60'000 && host.sample().sample.effort[3] != effort_n; ++i) {
    armAnewWhereLatched(host, device);
    ASSERT_EQ(device.write(efforts(effort_n, 0.0, 0.0)), Fault::kNone);
    sleepMs(1);
  }
}

TEST(HostedDevice, DeviceClosedWhileItPushes_GoesToNeutralBeforeItIsDisabled) {
  const std::string name = hostName("closes");
  HostThread host(name, faultyDriver(""), desktop());
  const auto device = deviceOf(orThrow(HostedDriver::connect(name)));
  ASSERT_TRUE(openEnabled(*device));
  const AsUrgentAsALoop urgent;
  ASSERT_NO_FATAL_FAILURE(pushUntilMeasured(host, *device, 4.0));
  ASSERT_EQ(host.sample().sample.effort[3], 4.0);
  const std::int64_t begun_ns = monotonicNow_ns();
  device->close();
  EXPECT_GE(monotonicNow_ns() - begun_ns, 75'000'000) << "the ramp takes 80 ms";
  const std::vector<HostEvent> events = host.events();
  ASSERT_GE(events.size(), 2U);
  const HostEvent& ramps = events[events.size() - 2];
  EXPECT_EQ(ramps.phase, HostPhase::kRamping);
  EXPECT_EQ(ramps.reason, ReleaseReason::kLoopEnded);
  EXPECT_EQ(events.back().phase, HostPhase::kIdle);
}

// The last command and the end arrive within one cycle of the host; it must see both.
TEST(HostedDevice, DeviceClosedRightAfterANeutralCommand_DoesNotRamp) {
  const std::string name = hostName("neutral");
  HostThread host(name, faultyDriver(""), desktop());
  for (int session = 0; session < 10; ++session) {
    const auto device = deviceOf(orThrow(HostedDriver::connect(name)));
    ASSERT_TRUE(openEnabled(*device));
    const AsUrgentAsALoop urgent;
    ASSERT_NO_FATAL_FAILURE(pushUntilMeasured(host, *device, 0.05));
    (void)host.events();
    ASSERT_EQ(device->write(efforts(0.0, 0.0, 0.0)), Fault::kNone);
    device->close();
    for (const HostEvent& event : host.events()) EXPECT_NE(event.phase, HostPhase::kRamping);
  }
}

struct Failing {
  const char* name;
  Fault reported;
};

class FailingHostedDevice : public testing::TestWithParam<Failing> {};

// Faults that a device reports reach the loop as they do without a host.
TEST_P(FailingHostedDevice, DeviceFault_IsReportedToTheLoop) {
  const std::string name = hostName("fails");
  HostThread host(name, faultyDriver(std::string(GetParam().name) + "@4000", "may_wait"),
                  desktop());
  const auto device = deviceOf(orThrow(HostedDriver::connect(name)));
  ASSERT_TRUE(openEnabled(*device));
  DeviceReading reading;
  bool reported = false, was_well = false;
  for (int i = 0; i < 5000 && !reported; ++i) {
    const Fault faults = device->read(reading, 1) | device->write(efforts(1.0, 0.0, 0.0));
    reported = any(faults & GetParam().reported);
    was_well = was_well || !any(faults & kStoppingFaults);
    sleepMs(1);
  }
  EXPECT_TRUE(was_well);
  EXPECT_TRUE(reported);
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, FailingHostedDevice,
    testing::Values(Failing{"unplug", Fault::kDeviceRead}, Failing{"missing", Fault::kDeviceRead},
                    Failing{"drive", Fault::kDriveFault}, Failing{"enable", Fault::kEnableLost},
                    Failing{"unhomed", Fault::kEnableLost}, Failing{"silenced", Fault::kEnableLost},
                    Failing{"hot", Fault::kDriveHot}, Failing{"backwards", Fault::kStaleSample},
                    Failing{"frozen", Fault::kStaleSample}, Failing{"blocks", Fault::kStaleSample},
                    Failing{"refuse", Fault::kDeviceWrite}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace wholehand::test
