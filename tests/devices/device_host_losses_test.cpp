// Losses of loop and host processes. WHOLEHAND_FULL loses 1,000 of each kind and looks for false
// alarms for 10 minutes.
// Each figure is judged by the host's own time stamps. A machine that does not run the host for a
// while delays it, so the host's longest gap between two cycles is added to the allowed time, and
// printed. An alarm is false if the loop's own clock shows no gap of 20 ms.
#include "devices/host/hosted_driver.hpp"
#include "devices/plugin/plugin_device.hpp"
#include "devices/plugin/plugin_driver.hpp"
#include "files/device/device_file.hpp"
#include "host_tools.hpp"
#include "plain_driver.hpp"
#include "support/contains.hpp"
#include "support/open_enabled.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <thread>

namespace wholehand::test {
namespace {

constexpr double kNeutralWithin_ms = 110.0;
constexpr double kLoopSilence_ms = 20.0;
constexpr double kPeriod_ms = 0.25;

bool full() {
  return std::getenv("WHOLEHAND_FULL") != nullptr;
}

std::string desktopFile() {
  return std::string(WHOLEHAND_SOURCE_DIR) + "/config/devices/desktop-3axis.toml";
}

// x carries its own weight, so that its neutral effort is not 0.
DeviceModel weighted() {
  DeviceModel model = orThrow(loadDeviceFile(desktopFile()));
  model.output_delay_ticks = 2;
  model.axes[0].neutral_effort = 0.5;
  return model;
}

struct SentEffort {
  std::int64_t at_ns;
  std::array<double, 3> effort;
};

/// A driver of three axes that stores every effort with its time.
class KeepingDriver final : public PlainDriver {
 public:
  KeepingDriver() : PlainDriver({"x", "y", "z"}, plainAxis()), given_(std::size_t{1} << 16U) {}
  [[nodiscard]] int read(wh_sample& sample) noexcept override {
    sample = {};
    sample.size = sizeof(sample);
    sample.status = WH_HOMED | (enabled ? std::uint32_t{WH_ENABLED} : 0U);
    sample.sequence = ++samples_;
    sample.monotonic_ns = monotonicNow_ns();
    sample.valid = 7;
    return WH_OK;
  }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    const std::size_t n = count_.load(std::memory_order_relaxed);
    given_[n % given_.size()] = {monotonicNow_ns(),
                                 {command.effort[0], command.effort[1], command.effort[2]}};
    count_.store(n + 1, std::memory_order_release);
    return WH_OK;
  }
  /// Efforts since that time; at most the last 60,000. Call it while no new ones matter.
  [[nodiscard]] std::vector<SentEffort> since(std::int64_t from_ns) const {
    const std::size_t n = count_.load(std::memory_order_acquire);
    std::vector<SentEffort> out;
    for (std::size_t i = n > 60'000 ? n - 60'000 : 0; i < n; ++i) {
      if (given_[i % given_.size()].at_ns >= from_ns) out.push_back(given_[i % given_.size()]);
    }
    return out;
  }

 private:
  std::uint64_t samples_ = 0;
  std::vector<SentEffort> given_;
  std::atomic<std::size_t> count_{0};
};

// Measured times of one loss.
struct Loss {
  double noticed_ms = 0.0;  ///< from the last command to the start of the ramp
  double neutral_ms = 0.0;  ///< from the last command to the neutral effort
  double late_ms = 0.0;     ///< delay of the host by the machine
};

// @pre the loop has been lost, and the host has latched
Loss lossOf(const KeepingDriver& driver, const std::vector<HostEvent>& events,
            const AxisEffort& neutral) {
  Loss loss;
  std::int64_t last_ns = 0, ramp_ns = 0;
  for (const HostEvent& event : events) {
    const double gap_ms = static_cast<double>(event.longest_gap_ns) * 1e-6;
    if (event.phase != HostPhase::kRamping && event.phase != HostPhase::kLatched) continue;
    EXPECT_EQ(event.reason, ReleaseReason::kLoopSilent);
    loss.late_ms += std::max(0.0, gap_ms - kPeriod_ms);
    if (event.phase != HostPhase::kRamping) continue;
    ramp_ns = event.at_ns;
    last_ns = event.at_ns - event.silent_ns;
    loss.noticed_ms = static_cast<double>(event.silent_ns) * 1e-6;
  }
  EXPECT_NE(ramp_ns, 0) << "no ramp";
  const std::vector<SentEffort> given = driver.since(ramp_ns - 1'000'000);
  std::int64_t neutral_ns = 0;
  for (std::size_t k = 1; k < given.size(); ++k) {
    if (given[k].at_ns < ramp_ns) continue;
    bool at_neutral = true;
    for (int i = 0; i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const double was = given[k - 1].effort[axis] - neutral[i];
      const double is = given[k].effort[axis] - neutral[i];
      EXPECT_LE(std::abs(is), std::abs(was)) << kAlways << "axis " << i << " rises";
      EXPECT_GE(is * was, 0.0) << kAlways << "axis " << i << " goes through neutral";
      // The steepest slope of the ramp from the largest effort, 8 N, over 80 ms; a write may be as
      // late as the host was.
      const double apart_ms =
          static_cast<double>(given[k].at_ns - given[k - 1].at_ns) * 1e-6 + kPeriod_ms;
      EXPECT_LE(std::abs(is - was), 1.5 * 8.5 / 80.0 * (apart_ms + loss.late_ms)) << "a step";
      at_neutral = at_neutral && is == 0.0;
    }
    if (at_neutral && neutral_ns == 0) neutral_ns = given[k].at_ns;
  }
  EXPECT_NE(neutral_ns, 0) << kAlways << "never neutral";
  loss.neutral_ms = static_cast<double>(neutral_ns - last_ns) * 1e-6;
  return loss;
}

struct Kind {
  const char* name;
  const char* partner;  ///< behaviour of the loop (host_partner.cpp)
  int signal;           ///< signal sent to it; 0: none
};

class LostLoop : public testing::TestWithParam<Kind> {};

TEST_P(LostLoop, LoopLost_IsTakenToNeutralWithin110ms) {
  const int losses = full() ? 1000 : 12;
  const std::string name = hostName("lost");
  const auto driver = std::make_shared<KeepingDriver>();
  const DeviceModel model = weighted();
  const AxisEffort neutral = model.neutral();
  HostThread host(name, driver, model);
  double noticed_ms = 0.0, neutral_ms = 0.0, late_ms = 0.0;
  int beyond = 0;
  for (int k = 0; k < losses; ++k) {
    const std::uint64_t session = host.sample().session + 1;
    Partner loop({"loop", name, GetParam().partner});
    ASSERT_TRUE(host.awaitsLoopOf(session));
    if (GetParam().signal != 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20 + 7 * (k % 5)));
      loop.send(GetParam().signal);
    }
    ASSERT_TRUE(host.awaits(HostPhase::kLatched));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const Loss loss = lossOf(*driver, host.events(), neutral);
    noticed_ms = std::max(noticed_ms, loss.noticed_ms);
    neutral_ms = std::max(neutral_ms, loss.neutral_ms);
    late_ms = std::max(late_ms, loss.late_ms);
    beyond += loss.neutral_ms > kNeutralWithin_ms ? 1 : 0;
    EXPECT_GT(loss.noticed_ms, kLoopSilence_ms) << "an alarm too early";
    EXPECT_LE(loss.neutral_ms, kNeutralWithin_ms + loss.late_ms);
    ASSERT_FALSE(HasFailure()) << "loss " << k;
  }
  const std::string what = std::string("loop lost by ") + GetParam().name + ", " +
                           std::to_string(losses) + " times, at the latest: ";
  figure(what + "noticed", noticed_ms, "ms");
  figure(what + "neutral", neutral_ms, "ms");
  figure(what + "the machine's own lateness", late_ms, "ms");
  figure(what + "beyond 110 ms", beyond, "times");
}
INSTANTIATE_TEST_SUITE_P(Kinds, LostLoop,
                         testing::Values(Kind{"KILL", "forever", SIGKILL},
                                         Kind{"STOP", "forever", SIGSTOP},
                                         Kind{"deadlock", "deadlock", 0},
                                         Kind{"runaway", "runaway", 0}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(LivingLoop, LoopBesideBusyPrograms_IsNeverReportedLost) {
  const int seconds = full() ? 600 : 5;
  const std::string name = hostName("alive");
  HostThread host(name, std::make_shared<KeepingDriver>(), weighted());
  std::atomic<bool> over{false};
  std::vector<std::thread> busy;
  for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i) {
    busy.emplace_back([&over] {
      while (!over.load(std::memory_order_relaxed)) {
      }
    });
  }
  const auto sleepMs = [](int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); };
  int false_alarms = 0, stalls = 0;
  double longest_ms = 0.0;
  for (int tenths = 0; tenths < seconds * 10;) {
    const std::uint64_t session = host.sample().session + 1;
    Partner loop({"loop", name, "forever"});
    ASSERT_TRUE(host.awaitsLoopOf(session));
    while (tenths < seconds * 10 && host.sample().phase == HostPhase::kRendering) {
      sleepMs(100);
      ++tenths;
    }
    const bool alarm = host.sample().phase != HostPhase::kRendering;
    if (alarm) sleepMs(500);  // the loop is alive: its next command shows how long it stood still
    HostCommand last{};
    ASSERT_TRUE(host.frame().command.take(last));
    longest_ms = std::max(longest_ms, last.effort[kGapAt]);
    if (alarm) ++(last.effort[kGapAt] > kLoopSilence_ms ? stalls : false_alarms);
  }
  EXPECT_EQ(false_alarms, 0);
  const std::string what = "device host beside busy programs, " + std::to_string(seconds) + " s: ";
  figure(what + "false alarms", false_alarms, "times");
  figure(what + "alarms where the machine let the loop stand still for over 20 ms", stalls,
         "times");
  figure(what + "longest time between two commands, by the loop's own clock", longest_ms, "ms");
  over.store(true);
  for (std::thread& thread : busy) thread.join();
}

// A way to lose a host: by a signal or by its driver's settings.
struct HostKind {
  const char* name;
  const char* settings;
  int signal;
};

class LostHost : public testing::TestWithParam<HostKind> {};

// The loop counts ticks: 20 ms are 20 ticks, and one more until the sample is older.
TEST_P(LostHost, HostLost_IsAFaultWithinTheLongestGap) {
  const int losses = full() ? 1000 : 12;
  const std::string name = hostName("dies");
  const std::string path = std::string(WHOLEHAND_BINARY_DIR) + "/drivers/may_wait.so";
  DeviceModel model = orThrow(loadDeviceFile(desktopFile()));
  model.output_delay_ticks = 2;
  int most = 0;
  std::shared_ptr<HostedDriver> driver;
  std::unique_ptr<HapticDevice> device;
  for (int k = 0, stalls = 0; k < losses; ++k) {
    Partner host({"host", name, path, GetParam().settings, desktopFile()});
    // The first host is connected to; later ones are found by a new arming.
    bool open = false;
    for (int i = 0; i < 60'000 && !open; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (!driver) {
        auto connected = HostedDriver::connect(name);
        if (!connected) continue;
        driver = *connected;
        device = orThrow(PluginDevice::make(driver, model, 1e-3));
      }
      open = (driver->reconnect() && openEnabled(*device));
    }
    ASSERT_TRUE(open) << "loss " << k;
    DeviceReading reading;
    int since = -1;
    Fault faults = Fault::kNone;
    LongestGap gap;
    const AsUrgentAsALoop urgent;
    for (int tick = 0; tick < 5000 && !any(faults); ++tick) {
      if (GetParam().signal != 0 && tick == 20) host.send(GetParam().signal);
      gap.note();
      faults = device->read(reading, 1) | device->write(AxisEffort(3, 1.0));
      since = tick - 20;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (any(faults & Fault::kEnableLost) && gap.longest_ms() > kLoopSilence_ms && stalls < losses) {
      ++stalls;  // the machine stalled this loop, so the host released it before dying
      --k;
      device->close();
      continue;
    }
    EXPECT_EQ(faults, Fault::kStaleSample) << "loss " << k;
    if (GetParam().signal != 0) {
      EXPECT_LE(since, 22) << "ticks of 1 ms after the loss";
      most = std::max(most, since);
    }
    device->close();
    ASSERT_FALSE(HasFailure()) << "loss " << k;
  }
  if (GetParam().signal != 0) {
    figure("host killed " + std::to_string(losses) + " times, ticks of 1 ms to the fault at most",
           most, "ticks");
  }
  driver.reset();
  device.reset();
  ::shm_unlink(("/wholehand-" + name).c_str());
  ::shm_unlink(("/wholehand-" + name + ".lock").c_str());
}
INSTANTIATE_TEST_SUITE_P(Kinds, LostHost,
                         testing::Values(HostKind{"KILL", "", SIGKILL},
                                         HostKind{"crash", "crashes@1500", 0}),
                         [](const auto& tested) { return std::string(tested.param.name); });

// The host keeps its last answer. An answer to the loop that died must not count for the next loop.
TEST(RestartedHost, HostRestartedAfterALostLoop_EnablesAgain) {
  const std::string name = hostName("restarted");
  const auto driver = std::make_shared<KeepingDriver>();
  const DeviceModel model = weighted();
  auto host = std::make_unique<HostThread>(name, driver, model);
  const auto hosted = orThrow(HostedDriver::connect(name));
  host.reset();
  host = std::make_unique<HostThread>(name, driver, model);
  {
    Partner other({"loop", name, "forever"});
    ASSERT_TRUE(host->awaitsLoopOf(1));
    other.send(SIGKILL);
    other.wait();
  }
  ASSERT_TRUE(host->awaits(HostPhase::kLatched));
  const std::uint64_t of_the_other = host->sample().session;
  ASSERT_TRUE(hosted->reconnect());
  const auto enabled = hosted->control(WH_ENABLE, 0.0);
  ASSERT_TRUE(enabled) << format(enabled.errors());
  EXPECT_EQ(host->sample().session, of_the_other + 1);
}

// The host is stopped, or its driver blocks forever.
TEST(StoppedHost, HostStopped_DoesNotBlockClosingAndIsNotArmed) {
  const std::string name = hostName("stopped");
  Partner host({"host", name, std::string(WHOLEHAND_BINARY_DIR) + "/drivers/may_wait.so", "",
                desktopFile()});
  std::shared_ptr<HostedDriver> driver;
  for (int i = 0; i < 60'000 && !driver; ++i) {
    if (auto connected = HostedDriver::connect(name)) driver = *connected;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_TRUE(driver);
  DeviceModel model = orThrow(loadDeviceFile(desktopFile()));
  model.output_delay_ticks = 2;
  const auto device = orThrow(PluginDevice::make(driver, model, 1e-3));
  ASSERT_TRUE(openEnabled(*device));
  host.send(SIGSTOP);
  const std::int64_t begun_ns = monotonicNow_ns();
  device->close();
  const auto opened = openEnabled(*device);
  EXPECT_TRUE(refusedWith(opened, "stands still"));
  EXPECT_LT(monotonicNow_ns() - begun_ns, 30'000'000'000) << "3 s and 1 s are waited for";
  host.send(SIGKILL);
  host.wait();
  ::shm_unlink(("/wholehand-" + name).c_str());
  ::shm_unlink(("/wholehand-" + name + ".lock").c_str());
}

}  // namespace
}  // namespace wholehand::test
