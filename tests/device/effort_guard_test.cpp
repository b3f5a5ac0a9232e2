// The part of a device host that decides which effort goes to the device: simulated time.
#include "device/host/effort_guard.hpp"

#include "support/figure.hpp"
#include "support/seed.hpp"

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
  config.most_change = AxisEffort(kAxes, 100.0);  // never acts, but where a test is about it
  return config;
}

HostCommand commandAt(std::uint64_t sequence, std::int64_t at_ns, double x, double y, double z) {
  HostCommand command{};
  command.session = 1;
  command.sequence = sequence;
  command.monotonic_ns = at_ns;
  command.axes = kAxes;
  command.effort[0] = x, command.effort[1] = y, command.effort[2] = z;
  return command;
}

GuardState rendering(const GuardConfig& config, const HostCommand& command) {
  const GuardState begun = beginSession(1, command.monotonic_ns, config);
  return advanceGuard(begun, &command, HostReason::kNone, 1, command.monotonic_ns, config);
}

TEST(EffortGuard, EveryNewCommand_IsPassedOnInItsCycleAndClamped) {
  const GuardConfig config = configAt(1000.0);
  GuardState guard = beginSession(1, kStart_ns, config);
  EXPECT_EQ(guard.phase, HostPhase::kWaiting);
  EXPECT_EQ(guard.ramp.sent[2], 1.5) << "neutral until the first command";
  for (int k = 1; k < 100; ++k) {
    const std::int64_t now_ns = kStart_ns + k * kMs;
    const HostCommand command =
        commandAt(static_cast<std::uint64_t>(k), now_ns, 0.01 * k, -9.0, 3.0);
    guard = advanceGuard(guard, &command, HostReason::kNone, 1, now_ns, config);
    EXPECT_EQ(guard.phase, HostPhase::kRendering);
    EXPECT_EQ(guard.ramp.sent[0], 0.01 * k);
    EXPECT_EQ(guard.ramp.sent[1], -8.0) << "the limit of the device file";
    EXPECT_EQ(guard.ramp.sent[2], 3.0);
  }
}

// The requirement: silence for 20 ms, then monotone to neutral, all within 110 ms of the last
// command, at every rate and however late the host itself is called.
TEST(EffortGuard, SilentLoop_IsAtNeutralWithin110msAndOnlyFalls) {
  auto random = seededRandom(901);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  double worst_ms = 0.0;
  for (int trial = 0; trial < 2000; ++trial) {
    const double rate_hz = uniform(1000.0, 16000.0);
    const auto period_ns = static_cast<std::int64_t>(1e9 / rate_hz);
    const GuardConfig config = configAt(rate_hz);
    const HostCommand last =
        commandAt(5, kStart_ns, uniform(-8.0, 8.0), uniform(-8.0, 8.0), uniform(-8.0, 8.0));
    GuardState guard = rendering(config, last);
    std::int64_t now_ns = kStart_ns;
    AxisEffort before = guard.ramp.sent;
    while (guard.phase != HostPhase::kLatched) {
      const int elapsed = uniform(0.0, 1.0) < 0.01 ? static_cast<int>(uniform(1.0, 8.0)) : 1;
      now_ns += elapsed * period_ns;
      guard = advanceGuard(guard, &last, HostReason::kNone, elapsed, now_ns, config);
      if (now_ns - kStart_ns <= 20 * kMs) {
        ASSERT_EQ(guard.phase, HostPhase::kRendering) << "no alarm before 20 ms";
      } else {
        ASSERT_NE(guard.phase, HostPhase::kRendering)
            << "no later than the first cycle after 20 ms";
      }
      for (int i = 0; i < kAxes; ++i) {
        const double was = before[i] - config.neutral[i];
        const double is = guard.ramp.sent[i] - config.neutral[i];
        ASSERT_LE(std::abs(is), std::abs(was)) << "falls";
        ASSERT_GE(is * was, 0.0) << "does not go through neutral";
        // The steepest slope of the smoothstep over 80 ms; the first cycle counts as one period.
        ASSERT_LE(std::abs(is - was), 1.5 / 0.08 * elapsed * config.period_s *
                                              std::abs(last.effort[i] - config.neutral[i]) +
                                          1e-12)
            << "no step";
      }
      before = guard.ramp.sent;
      ASSERT_LT(now_ns - kStart_ns, 200 * kMs);
    }
    for (int i = 0; i < kAxes; ++i) ASSERT_EQ(guard.ramp.sent[i], config.neutral[i]);
    EXPECT_EQ(guard.reason, HostReason::kLoopSilent);
    worst_ms = std::max(worst_ms, static_cast<double>(now_ns - kStart_ns) * 1e-6);
  }
  figure("device host in simulated time, last command to neutral", worst_ms, "ms");
  EXPECT_LE(worst_ms, 110.0);
}

TEST(EffortGuard, HostThatWasBlocked_JudgesTheLoopByItsTimeStamps) {
  const GuardConfig config = configAt(1000.0);
  const HostCommand last = commandAt(5, kStart_ns, 4.0, 0.0, 1.5);
  const std::int64_t later_ns = kStart_ns + 50 * kMs;
  // The loop went on: its newest command is 1 ms old.
  const HostCommand fresh = commandAt(54, later_ns - kMs, 5.0, 0.0, 1.5);
  GuardState lives =
      advanceGuard(rendering(config, last), &fresh, HostReason::kNone, 50, later_ns, config);
  EXPECT_EQ(lives.phase, HostPhase::kRendering);
  EXPECT_LT(lives.ramp.sent[0], 4.1) << "no step";
  for (int k = 1; k <= 30; ++k) {
    const HostCommand goes_on =
        commandAt(54 + static_cast<std::uint64_t>(k), later_ns + k * kMs, 5.0, 0.0, 1.5);
    lives = advanceGuard(lives, &goes_on, HostReason::kNone, 1, later_ns + k * kMs, config);
  }
  EXPECT_EQ(lives.ramp.sent[0], 5.0) << "blended in within 30 ms";
  // The loop died 25 ms ago: the ramp begins at what the device holds, not at what comes too late.
  const HostCommand old = commandAt(29, later_ns - 25 * kMs, -5.0, 0.0, 1.5);
  const GuardState died =
      advanceGuard(rendering(config, last), &old, HostReason::kNone, 50, later_ns, config);
  EXPECT_EQ(died.phase, HostPhase::kRamping);
  EXPECT_EQ(died.reason, HostReason::kLoopSilent);
  EXPECT_GT(died.ramp.sent[0], 3.9);
  EXPECT_LT(died.ramp.sent[0], 4.0);
}

// A host that stood still while its loop went to neutral: the device is not dropped.
TEST(EffortGuard, HostThatWasBlockedWhileTheLoopRamped_DoesNotDropTheEffort) {
  const GuardConfig config = configAt(1000.0);
  GuardState guard = rendering(config, commandAt(5, kStart_ns, 8.0, 0.0, 1.5));
  std::int64_t now_ns = kStart_ns + 200 * kMs;
  double before = guard.ramp.sent[0];
  int elapsed = 200;
  for (std::uint64_t k = 0; k < 40; ++k) {
    const HostCommand neutral = commandAt(205 + k, now_ns - kMs, 0.0, 0.0, 1.5);
    guard = advanceGuard(guard, &neutral, HostReason::kNone, elapsed, now_ns, config);
    // The steepest slope of the smoothstep over 30 ms.
    ASSERT_LE(before - guard.ramp.sent[0], 8.0 * 1.5 / 30.0 + 1e-12);
    before = guard.ramp.sent[0];
    elapsed = 1;
    now_ns += kMs;
  }
  EXPECT_EQ(guard.ramp.sent[0], 0.0);
}

// Blocked in the middle of the ramp: the slew limit is the last word.
TEST(EffortGuard, AnyEffort_ChangesByNoMoreThanTheSlewLimit) {
  auto random = seededRandom(903);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int trial = 0; trial < 200; ++trial) {
    GuardConfig config = configAt(1000.0);
    config.most_change = AxisEffort(kAxes, 2.0);
    GuardState guard = beginSession(1, kStart_ns, config);
    std::int64_t now_ns = kStart_ns;
    HostCommand command{};
    for (int k = 0; k < 400; ++k) {
      const int elapsed = uniform(0.0, 1.0) < 0.05 ? static_cast<int>(uniform(1.0, 60.0)) : 1;
      now_ns += elapsed * kMs;
      if (k < 150) {
        command = commandAt(static_cast<std::uint64_t>(k) + 1, now_ns, uniform(-9.0, 9.0),
                            uniform(-9.0, 9.0), uniform(-9.0, 9.0));
      }
      const AxisEffort before = guard.ramp.sent;
      guard = advanceGuard(guard, &command, HostReason::kNone, elapsed, now_ns, config);
      for (int i = 0; i < kAxes; ++i) {
        ASSERT_LE(std::abs(guard.ramp.sent[i] - before[i]), 2.0 + 1e-12);
        ASSERT_LE(std::abs(guard.ramp.sent[i]), 8.0);
      }
    }
    EXPECT_EQ(guard.phase, HostPhase::kLatched);
    for (int i = 0; i < kAxes; ++i) EXPECT_EQ(guard.ramp.sent[i], config.neutral[i]);
  }
}

TEST(EffortGuard, StampInTheFuture_GivesNoMoreTime) {
  const GuardConfig config = configAt(1000.0);
  const HostCommand first = commandAt(1, kStart_ns, 4.0, 0.0, 1.5);
  const HostCommand future = commandAt(2, kStart_ns + 1'000'000 * kMs, 4.0, 0.0, 1.5);
  GuardState guard = advanceGuard(rendering(config, first), &future, HostReason::kNone, 1,
                                  kStart_ns + kMs, config);
  guard = advanceGuard(guard, &future, HostReason::kNone, 1, kStart_ns + 22 * kMs, config);
  EXPECT_EQ(guard.phase, HostPhase::kRamping);
}

struct SpoiledOrder {
  const char* name;
  void (*spoil)(HostCommand&);
  HostReason reason;
};

class SpoiledCommand : public testing::TestWithParam<SpoiledOrder> {};

TEST_P(SpoiledCommand, IsNeverSentAndEndsAtNeutral) {
  const GuardConfig config = configAt(1000.0);
  const HostCommand first = commandAt(5, kStart_ns, 4.0, -2.0, 3.0);
  GuardState guard = rendering(config, first);
  for (int k = 1; k < 130; ++k) {
    HostCommand command =
        commandAt(5 + static_cast<std::uint64_t>(k), kStart_ns + k * kMs, 7.0, 7.0, 7.0);
    GetParam().spoil(command);
    guard = advanceGuard(guard, &command, HostReason::kNone, 1, kStart_ns + k * kMs, config);
    ASSERT_LE(guard.ramp.sent[0], 4.0) << k;
    ASSERT_LE(guard.ramp.sent[1], 0.0) << k;
  }
  EXPECT_EQ(guard.phase, HostPhase::kLatched);
  EXPECT_EQ(guard.reason, GetParam().reason);
  EXPECT_EQ(guard.ramp.sent[2], 1.5);
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, SpoiledCommand,
    testing::Values(
        SpoiledOrder{"not_a_number",
                     [](HostCommand& c) { c.effort[1] = std::numeric_limits<double>::quiet_NaN(); },
                     HostReason::kBadCommand},
        SpoiledOrder{"infinite",
                     [](HostCommand& c) { c.effort[0] = std::numeric_limits<double>::infinity(); },
                     HostReason::kBadCommand},
        SpoiledOrder{"of_other_axes", [](HostCommand& c) { c.axes = 6; }, HostReason::kBadCommand},
        SpoiledOrder{"of_absurd_axes", [](HostCommand& c) { c.axes = ~0ULL; },
                     HostReason::kBadCommand},
        SpoiledOrder{"of_another_session", [](HostCommand& c) { c.session = 0; },
                     HostReason::kLoopSilent},
        SpoiledOrder{"standing_still", [](HostCommand& c) { c.sequence = 5; },
                     HostReason::kLoopSilent},
        SpoiledOrder{"running_backwards", [](HostCommand& c) { c.sequence = 4 - c.sequence % 4; },
                     HostReason::kLoopSilent}),
    [](const auto& tested) { return tested.param.name; });

TEST(EffortGuard, Latched_HearsNobodyUntilANewSession) {
  const GuardConfig config = configAt(1000.0);
  const HostCommand last = commandAt(5, kStart_ns, 4.0, -2.0, 3.0);
  GuardState guard = rendering(config, last);
  std::int64_t now_ns = kStart_ns;
  for (int k = 0; k < 120; ++k) {
    now_ns += kMs;
    guard = advanceGuard(guard, &last, HostReason::kNone, 1, now_ns, config);
  }
  ASSERT_EQ(guard.phase, HostPhase::kLatched);
  for (int k = 0; k < 500; ++k) {  // the loop was stopped, not killed: it goes on
    now_ns += kMs;
    const HostCommand again = commandAt(6 + static_cast<std::uint64_t>(k), now_ns, 4.0, 4.0, 4.0);
    guard = advanceGuard(guard, &again, HostReason::kNone, 1, now_ns, config);
    ASSERT_EQ(guard.phase, HostPhase::kLatched);
    ASSERT_EQ(guard.ramp.sent[0], 0.0);
    ASSERT_EQ(guard.ramp.sent[2], 1.5);
  }
  guard = beginSession(2, now_ns, config);
  EXPECT_EQ(guard.phase, HostPhase::kWaiting);
  EXPECT_EQ(guard.reason, HostReason::kNone);
  HostCommand anew = commandAt(1, now_ns + kMs, 2.0, 0.0, 1.5);
  anew.session = 2;
  guard = advanceGuard(guard, &anew, HostReason::kNone, 1, now_ns + kMs, config);
  EXPECT_EQ(guard.phase, HostPhase::kRendering);
  EXPECT_EQ(guard.ramp.sent[0], 2.0);
}

TEST(EffortGuard, SilentWhereTheEffortIsNeutral_LatchesWithoutARamp) {
  const GuardConfig config = configAt(1000.0);
  const HostCommand last = commandAt(5, kStart_ns, 0.0, 0.0, 1.5);
  const GuardState guard = advanceGuard(rendering(config, last), &last, HostReason::kNone, 1,
                                        kStart_ns + 21 * kMs, config);
  EXPECT_EQ(guard.phase, HostPhase::kLatched);
  EXPECT_EQ(guard.reason, HostReason::kSilentAtNeutral);
}

TEST(EffortGuard, ToldToLetGo_RampsWhateverTheLoopCommands) {
  const GuardConfig config = configAt(1000.0);
  GuardState guard = rendering(config, commandAt(5, kStart_ns, 4.0, 0.0, 1.5));
  for (int k = 1; k <= 80; ++k) {
    const HostCommand more =
        commandAt(5 + static_cast<std::uint64_t>(k), kStart_ns + k * kMs, 4.0, 0.0, 1.5);
    guard = advanceGuard(guard, &more, HostReason::kHostEnds, 1, kStart_ns + k * kMs, config);
  }
  EXPECT_EQ(guard.phase, HostPhase::kLatched);
  EXPECT_EQ(guard.reason, HostReason::kHostEnds);
  EXPECT_EQ(guard.ramp.sent[0], 0.0);
}

// A host that stood still blends in what it missed: the loop has come to neutral and ended before
// the device has. That is no loop to be let go of, and no step for the device.
TEST(EffortGuard, LoopThatEndedAtNeutralWhileTheHostWasBlocked_IsFollowedAndNotBlamed) {
  const GuardConfig config = configAt(1000.0);
  const HostCommand pushes = commandAt(5, kStart_ns, 4.0, -2.0, 1.5);
  const std::int64_t back_ns = kStart_ns + 9 * kMs;
  const HostCommand neutral = commandAt(12, back_ns - kMs, 0.0, 0.0, 1.5);
  GuardState guard =
      advanceGuard(rendering(config, pushes), &neutral, HostReason::kNone, 9, back_ns, config);
  ASSERT_GT(guard.ramp.sent[0], 0.0) << "else the test is about nothing";
  AxisEffort before = guard.ramp.sent;
  int cycles = 0;
  while (guard.phase != HostPhase::kLatched && ++cycles < 200) {
    guard =
        advanceGuard(guard, &neutral, HostReason::kLoopEnded, 1, back_ns + cycles * kMs, config);
    EXPECT_EQ(guard.reason, HostReason::kNone);
    for (int i = 0; i < 2; ++i) {
      EXPECT_LE(std::abs(guard.ramp.sent[i]), std::abs(before[i])) << "falls";
      EXPECT_LE(std::abs(guard.ramp.sent[i] - before[i]), 4.0 * 1.5 / 30.0) << "no step";
    }
    before = guard.ramp.sent;
  }
  EXPECT_LE(cycles, 110);
  EXPECT_EQ(guard.ramp.sent[0], 0.0);
  const GuardState pushing =
      advanceGuard(rendering(config, pushes), &pushes, HostReason::kLoopEnded, 1, back_ns, config);
  EXPECT_EQ(pushing.reason, HostReason::kLoopEnded) << "one that ended while it pushed is";
}

TEST(EffortGuard, EnabledAndNeverCommanded_StaysNeutralAndLatches) {
  const GuardConfig config = configAt(1000.0);
  const GuardState begun = beginSession(1, kStart_ns, config);
  const GuardState waits =
      advanceGuard(begun, nullptr, HostReason::kNone, 1, kStart_ns + 9'000 * kMs, config);
  EXPECT_EQ(waits.phase, HostPhase::kWaiting);
  const GuardState gave_up =
      advanceGuard(waits, nullptr, HostReason::kNone, 1, kStart_ns + 10'001 * kMs, config);
  EXPECT_EQ(gave_up.phase, HostPhase::kLatched);
  EXPECT_EQ(gave_up.reason, HostReason::kNeverCommanded);
}

}  // namespace
}  // namespace wholehand::test
