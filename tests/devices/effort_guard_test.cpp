// The effort guard of a device host, which decides which effort goes to the device, in simulated
// time.
#include "devices/host/effort_guard.hpp"

#include "support/figure.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace wholehand::test {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kStart_ns = 77'000'000'000;
constexpr int kAxes = 3;

GuardConfig configAt(double rate_hz) {
  GuardConfig config;
  config.period_s = 1.0 / rate_hz;
  config.neutral = AxisEffort(kAxes);
  config.neutral[2] = 1.5;  // carries its own weight
  config.limit = AxisEffort(kAxes, 8.0);
  config.most_change = AxisEffort(kAxes, 100.0);  // so large that it acts only in the tests of it
  return config;
}

/// A command of session 1 at `at_ms` [ms].
HostCommand commandAt(int sequence, std::int64_t at_ms, double x, double y, double z) {
  HostCommand command{};
  command.session = 1;
  command.sequence = static_cast<std::uint64_t>(sequence);
  command.monotonic_ns = kStart_ns + at_ms * kMs;
  command.axes = kAxes;
  command.effort[0] = x, command.effort[1] = y, command.effort[2] = z;
  return command;
}

/// A guard whose session begins at 0 ms.
struct Guard {
  explicit Guard(double rate_hz = 1000.0)
      : config(configAt(rate_hz)), state(beginSession(1, kStart_ns, config)) {}
  /// The guard renders since this command.
  explicit Guard(const HostCommand& first, double rate_hz = 1000.0) : Guard(rate_hz) {
    cycleAt(kStart_ns, &first);
  }
  void cycleAt(std::int64_t now_ns, const HostCommand* newest, int elapsed = 1,
               ReleaseReason reported = ReleaseReason::kNone) {
    state = advanceGuard(state, newest, reported, elapsed, now_ns, config);
  }
  void cycle(std::int64_t at_ms, const HostCommand& newest, int elapsed = 1,
             ReleaseReason reported = ReleaseReason::kNone) {
    cycleAt(kStart_ns + at_ms * kMs, &newest, elapsed, reported);
  }
  [[nodiscard]] double sent(int axis) const { return state.ramp.sent[axis]; }
  void expect(HostPhase phase, ReleaseReason reason) const {
    EXPECT_EQ(state.phase, phase);
    EXPECT_EQ(state.reason, reason);
  }

  GuardConfig config;
  GuardState state;
};

/// Returns a function that draws between two numbers.
auto between(std::mt19937_64& random) {
  return [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
}

TEST(EffortGuard, EveryNewCommand_IsPassedOnInItsCycleAndClamped) {
  Guard guard;
  EXPECT_EQ(guard.state.phase, HostPhase::kWaiting);
  EXPECT_EQ(guard.sent(2), 1.5) << "neutral until the first command";
  for (int k = 1; k < 100; ++k) {
    guard.cycle(k, commandAt(k, k, 0.01 * k, -9.0, 3.0));
    EXPECT_EQ(guard.state.phase, HostPhase::kRendering);
    EXPECT_EQ(guard.sent(0), 0.01 * k);
    EXPECT_EQ(guard.sent(1), -8.0) << "the limit of the device file";
    EXPECT_EQ(guard.sent(2), 3.0);
  }
}

// Requirement: after 20 ms of silence, a monotone ramp to neutral, all within 110 ms of the last
// command, at every rate and however late the host itself is called.
TEST(EffortGuard, SilentLoop_FallsMonotonicallyToNeutralWithin110ms) {
  auto random = seededRandom(901);
  const auto uniform = between(random);
  double worst_ms = 0.0;
  for (int trial = 0; trial < cases(2000); ++trial) {
    const double rate_hz = uniform(1000.0, 16000.0);
    const auto period_ns = static_cast<std::int64_t>(1e9 / rate_hz);
    const HostCommand last =
        commandAt(5, 0, uniform(-8.0, 8.0), uniform(-8.0, 8.0), uniform(-8.0, 8.0));
    Guard guard(last, rate_hz);
    const AxisEffort& neutral = guard.config.neutral;
    std::int64_t now_ns = kStart_ns;
    while (guard.state.phase != HostPhase::kLatched) {
      const int elapsed = uniform(0.0, 1.0) < 0.01 ? static_cast<int>(uniform(1.0, 8.0)) : 1;
      now_ns += elapsed * period_ns;
      const AxisEffort before = guard.state.ramp.sent;
      guard.cycleAt(now_ns, &last, elapsed);
      ASSERT_EQ(guard.state.phase == HostPhase::kRendering, now_ns - kStart_ns <= 20 * kMs)
          << "no alarm before 20 ms, and no later than the first cycle after";
      for (int i = 0; i < kAxes; ++i) {
        const double was = before[i] - neutral[i], is = guard.sent(i) - neutral[i];
        ASSERT_LE(std::abs(is), std::abs(was)) << "falls";
        ASSERT_GE(is * was, 0.0) << "does not go through neutral";
        // The steepest slope of the smoothstep over 80 ms; the first cycle counts as one period.
        const double most =
            1.5 / 0.08 * elapsed * guard.config.period_s * std::abs(last.effort[i] - neutral[i]);
        ASSERT_LE(std::abs(is - was), most + 1e-12) << "no step";
      }
      ASSERT_LT(now_ns - kStart_ns, 200 * kMs);
    }
    for (int i = 0; i < kAxes; ++i) ASSERT_EQ(guard.sent(i), neutral[i]);
    EXPECT_EQ(guard.state.reason, ReleaseReason::kLoopSilent);
    worst_ms = std::max(worst_ms, static_cast<double>(now_ns - kStart_ns) * 1e-6);
  }
  figure("device host in simulated time, last command to neutral", worst_ms, "ms");
  EXPECT_LE(worst_ms, 110.0);
}

TEST(EffortGuard, BlockedHost_JudgesTheLoopByItsTimeStamps) {
  const HostCommand last = commandAt(5, 0, 4.0, 0.0, 1.5);
  // The loop continued: its newest command is 1 ms old.
  Guard lives(last);
  lives.cycle(50, commandAt(54, 49, 5.0, 0.0, 1.5), 50);
  EXPECT_EQ(lives.state.phase, HostPhase::kRendering);
  EXPECT_LT(lives.sent(0), 4.1) << "no step";
  for (int k = 1; k <= 30; ++k) lives.cycle(50 + k, commandAt(54 + k, 50 + k, 5.0, 0.0, 1.5));
  EXPECT_EQ(lives.sent(0), 5.0) << "blended in within 30 ms";
  // The loop died 25 ms ago: the ramp begins at the effort of the device, not at the late command.
  Guard died(last);
  died.cycle(50, commandAt(29, 25, -5.0, 0.0, 1.5), 50);
  died.expect(HostPhase::kRamping, ReleaseReason::kLoopSilent);
  EXPECT_GT(died.sent(0), 3.9);
  EXPECT_LT(died.sent(0), 4.0);
}

// If the host stood still while its loop ramped to neutral, the device's effort must not drop in a
// step.
TEST(EffortGuard, HostBlockedWhileTheLoopRamped_DoesNotStepTheEffort) {
  Guard guard(commandAt(5, 0, 8.0, 0.0, 1.5));
  for (int k = 0; k < 40; ++k) {
    const double before = guard.sent(0);
    guard.cycle(200 + k, commandAt(205 + k, 199 + k, 0.0, 0.0, 1.5), k == 0 ? 200 : 1);
    // The steepest slope of the smoothstep over 30 ms.
    ASSERT_LE(before - guard.sent(0), 8.0 * 1.5 / 30.0 + 1e-12);
  }
  EXPECT_EQ(guard.sent(0), 0.0);
}

// Also if the host is blocked during the ramp, the slew limit has the last word.
TEST(EffortGuard, AnyEffort_ChangesByNoMoreThanTheSlewLimit) {
  auto random = seededRandom(903);
  const auto uniform = between(random);
  for (int trial = 0; trial < cases(200); ++trial) {
    Guard guard;
    guard.config.most_change = AxisEffort(kAxes, 2.0);
    guard.state = beginSession(1, kStart_ns, guard.config);
    int now_ms = 0;
    HostCommand command{};
    for (int k = 0; k < 400; ++k) {
      const int elapsed = uniform(0.0, 1.0) < 0.05 ? static_cast<int>(uniform(1.0, 60.0)) : 1;
      now_ms += elapsed;
      if (k < 150) {
        command =
            commandAt(k + 1, now_ms, uniform(-9.0, 9.0), uniform(-9.0, 9.0), uniform(-9.0, 9.0));
      }
      const AxisEffort before = guard.state.ramp.sent;
      guard.cycle(now_ms, command, elapsed);
      for (int i = 0; i < kAxes; ++i) {
        ASSERT_LE(std::abs(guard.sent(i) - before[i]), 2.0 + 1e-12);
        ASSERT_LE(std::abs(guard.sent(i)), 8.0);
      }
    }
    EXPECT_EQ(guard.state.phase, HostPhase::kLatched);
    for (int i = 0; i < kAxes; ++i) EXPECT_EQ(guard.sent(i), guard.config.neutral[i]);
  }
}

TEST(EffortGuard, StampInTheFuture_GivesNoMoreTime) {
  Guard guard(commandAt(1, 0, 4.0, 0.0, 1.5));
  const HostCommand future = commandAt(2, 1'000'000, 4.0, 0.0, 1.5);
  guard.cycle(1, future);
  guard.cycle(22, future);
  EXPECT_EQ(guard.state.phase, HostPhase::kRamping);
}

struct FaultyOrder {
  const char* name;
  void (*corrupt)(HostCommand&);
  ReleaseReason reason;
};

class FaultyCommand : public testing::TestWithParam<FaultyOrder> {};

TEST_P(FaultyCommand, BadCommand_IsNeverSentAndEndsAtNeutral) {
  Guard guard(commandAt(5, 0, 4.0, -2.0, 3.0));
  for (int k = 1; k < 130; ++k) {
    HostCommand command = commandAt(5 + k, k, 7.0, 7.0, 7.0);
    GetParam().corrupt(command);
    guard.cycle(k, command);
    ASSERT_LE(guard.sent(0), 4.0) << k;
    ASSERT_LE(guard.sent(1), 0.0) << k;
  }
  guard.expect(HostPhase::kLatched, GetParam().reason);
  EXPECT_EQ(guard.sent(2), 1.5);
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, FaultyCommand,
    testing::Values(
        FaultyOrder{"not_a_number",
                    [](HostCommand& c) { c.effort[1] = std::numeric_limits<double>::quiet_NaN(); },
                    ReleaseReason::kBadCommand},
        FaultyOrder{"infinite",
                    [](HostCommand& c) { c.effort[0] = std::numeric_limits<double>::infinity(); },
                    ReleaseReason::kBadCommand},
        FaultyOrder{"of_other_axes", [](HostCommand& c) { c.axes = 6; },
                    ReleaseReason::kBadCommand},
        FaultyOrder{"of_absurd_axes", [](HostCommand& c) { c.axes = ~0ULL; },
                    ReleaseReason::kBadCommand},
        FaultyOrder{"of_another_session", [](HostCommand& c) { c.session = 0; },
                    ReleaseReason::kLoopSilent},
        FaultyOrder{"standing_still", [](HostCommand& c) { c.sequence = 5; },
                    ReleaseReason::kLoopSilent},
        FaultyOrder{"running_backwards", [](HostCommand& c) { c.sequence = 4 - c.sequence % 4; },
                    ReleaseReason::kLoopSilent}),
    [](const auto& tested) { return tested.param.name; });

TEST(EffortGuard, LatchedGuard_IgnoresCommandsUntilANewSession) {
  const HostCommand last = commandAt(5, 0, 4.0, -2.0, 3.0);
  Guard guard(last);
  for (int k = 1; k <= 120; ++k) guard.cycle(k, last);
  ASSERT_EQ(guard.state.phase, HostPhase::kLatched);
  for (int k = 0; k < 500; ++k) {  // the loop was only stopped and continues
    guard.cycle(121 + k, commandAt(6 + k, 121 + k, 4.0, 4.0, 4.0));
    ASSERT_EQ(guard.state.phase, HostPhase::kLatched);
    ASSERT_EQ(guard.sent(0), 0.0);
    ASSERT_EQ(guard.sent(2), 1.5);
  }
  guard.state = beginSession(2, kStart_ns + 620 * kMs, guard.config);
  guard.expect(HostPhase::kWaiting, ReleaseReason::kNone);
  HostCommand anew = commandAt(1, 621, 2.0, 0.0, 1.5);
  anew.session = 2;
  guard.cycle(621, anew);
  EXPECT_EQ(guard.state.phase, HostPhase::kRendering);
  EXPECT_EQ(guard.sent(0), 2.0);
}

TEST(EffortGuard, SilenceAtTheNeutralEffort_LatchesWithoutARamp) {
  const HostCommand last = commandAt(5, 0, 0.0, 0.0, 1.5);
  Guard guard(last);
  guard.cycle(21, last);
  guard.expect(HostPhase::kLatched, ReleaseReason::kSilentAtNeutral);
}

TEST(EffortGuard, EndingHost_RampsRegardlessOfTheLoopsCommands) {
  Guard guard(commandAt(5, 0, 4.0, 0.0, 1.5));
  for (int k = 1; k <= 80; ++k) {
    guard.cycle(k, commandAt(5 + k, k, 4.0, 0.0, 1.5), 1, ReleaseReason::kHostEnds);
  }
  guard.expect(HostPhase::kLatched, ReleaseReason::kHostEnds);
  EXPECT_EQ(guard.sent(0), 0.0);
}

// After a standstill, the host blends in the missed commands. Here the loop has come to neutral and
// ended before the device has. This is no fault of the loop, and the device sees no step.
TEST(EffortGuard, LoopEndedAtNeutralWhileTheHostWasBlocked_IsFollowedWithoutAFault) {
  const HostCommand pushes = commandAt(5, 0, 4.0, -2.0, 1.5);
  const HostCommand neutral = commandAt(12, 8, 0.0, 0.0, 1.5);
  Guard guard(pushes);
  guard.cycle(9, neutral, 9);
  ASSERT_GT(guard.sent(0), 0.0) << "else the test is about nothing";
  int cycles = 0;
  while (guard.state.phase != HostPhase::kLatched && ++cycles < 200) {
    const AxisEffort before = guard.state.ramp.sent;
    guard.cycle(9 + cycles, neutral, 1, ReleaseReason::kLoopEnded);
    EXPECT_EQ(guard.state.reason, ReleaseReason::kNone);
    for (int i = 0; i < 2; ++i) {
      EXPECT_LE(std::abs(guard.sent(i)), std::abs(before[i])) << "falls";
      EXPECT_LE(std::abs(guard.sent(i) - before[i]), 4.0 * 1.5 / 30.0) << "no step";
    }
  }
  EXPECT_LE(cycles, 110);
  EXPECT_EQ(guard.sent(0), 0.0);
  Guard pushing(pushes);
  pushing.cycle(9, pushes, 1, ReleaseReason::kLoopEnded);
  EXPECT_EQ(pushing.state.reason, ReleaseReason::kLoopEnded) << "one that ended while it pushed is";
}

TEST(EffortGuard, EnabledWithoutACommand_StaysNeutralAndLatches) {
  Guard guard;
  guard.cycleAt(kStart_ns + 9'000 * kMs, nullptr);
  EXPECT_EQ(guard.state.phase, HostPhase::kWaiting);
  guard.cycleAt(kStart_ns + 10'001 * kMs, nullptr);
  guard.expect(HostPhase::kLatched, ReleaseReason::kNeverCommanded);
}

}  // namespace
}  // namespace wholehand::test
