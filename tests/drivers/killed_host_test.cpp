// Kills the program that drives a device and judges the device by the firmware's own clock. If the
// machine does not run the firmware for a while, this delay is allowed for and printed.
// WHOLEHAND_FULL=1 kills 1,000 programs.
#include "devices/plugin/plugin_driver.hpp"
#include "firmware_process.hpp"
#include "frame_bench.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

namespace wholehand::test {
namespace {

constexpr double kHostSilence_ms = 20.0;
constexpr double kRamp_ms = 80.0;
constexpr double kTick_ms = 0.25;
constexpr double kTolerance_ms = 1.0;  // ticks are not exactly on time

// Renders until the process is killed.
[[noreturn]] void render(const std::string& locator) {
  auto driver = PluginDriver::load({"frame", locator, ""});
  const Expected<Done> enabled = driver ? (*driver)->control(WH_ENABLE, 0.0) : driver.errors();
  if (!enabled) {
    std::fprintf(stderr, "%s\n", format(enabled.errors()).c_str());
    ::_exit(1);
  }
  for (std::uint64_t n = 1;; ++n) {
    (void)(*driver)->write(commandOf({6.0, -4.0, 2.0}, n));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

class KilledHost : public testing::TestWithParam<int> {};

TEST_P(KilledHost, KilledProgram_LeavesTheFirmwareAtNeutralWithinSilenceAndRamp) {
  const int losses = std::getenv("WHOLEHAND_FULL") != nullptr ? 334 : 8;
  const std::string where = everyCarrier()[GetParam()];
  FirmwareProcess firmware(where);
  auto random = seededRandom(1231);
  double latest_ms = 0.0, longest_gap_ms = 0.0;
  int late = 0;
  for (int k = 0; k < losses; ++k) {
    const pid_t host = ::fork();
    if (host == 0) render(firmware.locator());
    const PhaseLine rendering = firmware.until("rendering");
    std::this_thread::sleep_for(std::chrono::microseconds(5000 + random() % 20'000));
    ::kill(host, SIGKILL);
    int status = 0;
    ::waitpid(host, &status, 0);
    ASSERT_EQ(rendering.phase, "rendering") << "the host ended by itself: " << status;
    const PhaseLine ramping = firmware.until("ramping");
    const PhaseLine neutral = firmware.until("latched");
    ASSERT_EQ(neutral.phase, "latched");
    const double gap_ms =
        std::max(0.0, ramping.gap_ms - kTick_ms) + std::max(0.0, neutral.gap_ms - kTick_ms);
    EXPECT_GT(ramping.silent_ms, kHostSilence_ms) << kAlways << "an alarm too early";
    EXPECT_NEAR(ramping.most_effort, 6.0, 0.1) << "nothing was given: the test proves nothing";
    EXPECT_EQ(neutral.most_effort, 0.0) << kAlways;
    EXPECT_LE(neutral.silent_ms, kHostSilence_ms + kRamp_ms + kTolerance_ms + gap_ms)
        << "loss " << k;
    latest_ms = std::max(latest_ms, neutral.silent_ms);
    longest_gap_ms = std::max(longest_gap_ms, gap_ms);
    if (neutral.silent_ms > kHostSilence_ms + kRamp_ms + kTolerance_ms) ++late;
    ASSERT_FALSE(HasFailure()) << "loss " << k;
  }
  const std::string what =
      "host killed " + std::to_string(losses) + " times, " + where.substr(0, where.find(':'));
  figure(what + ", neutral after the last command at the latest", latest_ms, "ms");
  figure(what + ", later than 101 ms", late, "times");
  figure(what + ", the machine's own lateness at most", longest_gap_ms, "ms");
}
std::string carrierName(const testing::TestParamInfo<int>& tested) {
  static constexpr std::array<const char*, 3> kNames = {"udp", "serial", "shm"};
  return kNames.at(static_cast<std::size_t>(tested.param));
}
INSTANTIATE_TEST_SUITE_P(Carriers, KilledHost, testing::Range(0, 3), carrierName);

}  // namespace
}  // namespace wholehand::test
