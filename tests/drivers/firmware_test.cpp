// The reference firmware on a simulated clock: its behaviour for any input from a program.
#include "frame_bench.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace wholehand::test {
namespace {

constexpr std::uint32_t kSession = 5;

class Firmware : public testing::Test {
 protected:
  void send(std::uint8_t kind, std::uint8_t index = 0, std::vector<float> efforts = {},
            std::uint32_t session = kSession) {
    wf_frame frame{};
    frame.kind = kind;
    frame.axes = kind == WF_COMMAND ? static_cast<std::uint8_t>(efforts.size()) : 3;
    frame.index = index;
    frame.session = session;
    if (kind == WF_CONTROL && index == WH_ENABLE && commands_ != 0) commands_ += WF_ENABLE_SKIP;
    frame.sequence = kind == WF_COMMAND ? ++commands_ : ++questions_;
    std::copy(efforts.begin(), efforts.end(), frame.effort);
    put(frame);
  }
  void put(const wf_frame& frame) {
    std::array<std::uint8_t, WF_MAX_WIRE> wire{};
    const std::size_t count = wf_encode(&frame, wire.data());
    bench_.wires->to_device.insert(bench_.wires->to_device.end(), wire.begin(),
                                   wire.begin() + static_cast<std::ptrdiff_t>(count));
  }
  void enable() {
    send(WF_HELLO);
    send(WF_CONTROL, WH_ENABLE);
    bench_.pass();
  }
  // Enables the device and commands these efforts for 5 ms.
  void render(const std::vector<float>& efforts) {
    enable();
    for (int i = 0; i < 5; ++i) {
      send(WF_COMMAND, 0, efforts);
      bench_.pass();
    }
    ASSERT_EQ(bench_.fw.phase, FW_RENDERING);
  }
  [[nodiscard]] wf_frame newest(std::uint8_t kind) {
    wf_frame found{};
    for (const std::uint8_t byte : bench_.wires->from_device) {
      wf_frame frame{};
      if (wf_receive(&receiver_, byte, &frame) == WF_GOOD && frame.kind == kind) found = frame;
    }
    bench_.wires->from_device.clear();
    return found;
  }
  // Runs until neutral and checks that every axis falls monotonically towards it, all by the same
  // share. Returns the time [ms].
  int expectRamp(const std::vector<float>& from) {
    std::vector<float> before = from;
    for (int ms = 1; ms <= 200; ++ms) {
      bench_.pass();
      double share = -1.0;
      bool neutral = true;
      for (std::size_t i = 0; i < from.size(); ++i) {
        const float rest = bench_.board.neutral[i];
        const float now = bench_.given[i];
        EXPECT_LE(std::abs(now - rest), std::abs(before[i] - rest)) << "rises at " << ms << " ms";
        EXPECT_GE((now - rest) * (from[i] - rest), 0.0F) << "goes through neutral";
        if (from[i] != rest) {
          const double is = static_cast<double>((now - rest) / (from[i] - rest));
          if (share >= 0.0) {
            EXPECT_NEAR(is, share, 1e-5) << "another share at " << ms << " ms";
          }
          share = is;
        }
        neutral = neutral && now == rest;
        before[i] = now;
      }
      if (neutral) return ms;
    }
    return 200;
  }

  BenchBoard bench_;
  wf_receiver receiver_{};
  std::uint32_t commands_ = 0, questions_ = 0;
};

TEST_F(Firmware, CommandBeforeEnable_GivesNoEffort) {
  send(WF_HELLO);
  send(WF_COMMAND, 0, {1.0F, 2.0F, 3.0F});
  bench_.pass();
  EXPECT_FALSE(bench_.on);
  EXPECT_EQ(bench_.given[0], 0.0F);
  EXPECT_EQ(newest(WF_SAMPLE).status, static_cast<std::uint32_t>(WH_HOMED));
}

TEST_F(Firmware, Command_ActsInItsTickAndIsReportedInTheSample) {
  render({1.0F, -2.0F, 3.0F});
  EXPECT_EQ(bench_.given[1], -2.0F);
  const wf_frame sample = newest(WF_SAMPLE);
  EXPECT_EQ(sample.heard, 5U);
  EXPECT_EQ(sample.status, static_cast<std::uint32_t>(WH_HOMED | WH_ENABLED));
}

TEST_F(Firmware, EffortBeyondTheLimit_IsClampedAndReported) {
  render({99.0F, -99.0F, 8.0F});
  EXPECT_EQ(bench_.given[0], 8.0F);
  EXPECT_EQ(bench_.given[1], -8.0F);
  EXPECT_NE(newest(WF_SAMPLE).status & WH_SATURATED, 0U);
  send(WF_COMMAND, 0, {1.0F, 1.0F, 1.0F});
  bench_.pass();
  EXPECT_EQ(newest(WF_SAMPLE).status & WH_SATURATED, 0U);
}

// 20 ms of silence and 80 ms of ramp: at most 100 ms plus one tick.
TEST_F(Firmware, Silence_RampsAllAxesMonotonicallyWithin80ms) {
  bench_.board.neutral[1] = 1.5F;
  const std::vector<float> held = {6.0F, -3.0F, 0.02F};
  render(held);
  for (int ms = 0; ms < 20; ++ms) {
    bench_.pass();
    ASSERT_EQ(bench_.fw.phase, FW_RENDERING) << "an alarm too early, at " << ms << " ms";
    ASSERT_EQ(bench_.given[0], 6.0F);
  }
  const int ramp_ms = expectRamp(held);
  EXPECT_GE(ramp_ms, 79);
  EXPECT_LE(ramp_ms, 81);
}

// Smoothstep: s(1/4) = 1 - 3/16 + 2/64 = 27/32, s(1/2) = 1/2.
TEST_F(Firmware, Ramp_IsTheSmoothstepOfTheLoop) {
  render({8.0F, 4.0F, 0.0F});
  bench_.pass(20 + 20);  // 20 ms of silence, then 20 ms of ramp
  ASSERT_EQ(bench_.fw.phase, FW_RAMPING);
  EXPECT_NEAR(bench_.given[0], 8.0 * 27.0 / 32.0, 1e-5);
  bench_.pass(20);
  EXPECT_NEAR(bench_.given[0], 4.0, 1e-5);
  EXPECT_NEAR(bench_.given[1], 2.0, 1e-5);
}

TEST_F(Firmware, SilencedFirmware_ReportsItAndIgnoresCommandsUntilEnabled) {
  render({6.0F, 0.0F, 0.0F});
  bench_.pass(30);
  EXPECT_NE(newest(WF_SAMPLE).status & WH_SILENCED, 0U) << "while it ramps";
  bench_.pass(100);
  for (int i = 0; i < 10; ++i) {
    send(WF_COMMAND, 0, {5.0F, 5.0F, 5.0F});
    bench_.pass();
    ASSERT_EQ(bench_.given[0], 0.0F);
  }
  const wf_frame latched = newest(WF_SAMPLE);
  EXPECT_NE(latched.status & WH_SILENCED, 0U);
  EXPECT_NE(latched.status & WH_ENABLED, 0U) << "it carries its weight, and stays on";
  send(WF_CONTROL, WH_ENABLE);
  send(WF_COMMAND, 0, {5.0F, 5.0F, 5.0F});
  bench_.pass();
  EXPECT_EQ(newest(WF_SAMPLE).status & WH_SILENCED, 0U);
  EXPECT_EQ(bench_.given[0], 5.0F);
}

// A controller that stood still finds a line full of commands afterwards.
TEST_F(Firmware, CommandThatWaitedForAStoppedFirmware_IsIgnored) {
  render({6.0F, 0.0F, 0.0F});
  send(WF_COMMAND, 0, {-8.0F, -8.0F, -8.0F});
  bench_.now_us += 1'000'000;
  bench_.tick();
  EXPECT_GE(bench_.given[0], 0.0F);
  EXPECT_EQ(bench_.given[1], 0.0F);
  bench_.pass(100);
  EXPECT_EQ(bench_.fw.phase, FW_LATCHED);
}

TEST_F(Firmware, NonFiniteCommandOrOtherAxes_RampsToNeutral) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const std::vector<float>& bad :
       std::vector<std::vector<float>>{{1.0F, nan, 1.0F}, {infinity, 0.0F, 0.0F}, {1.0F, 1.0F}}) {
    render({6.0F, 3.0F, 1.0F});
    send(WF_COMMAND, 0, bad);
    EXPECT_LE(expectRamp({6.0F, 3.0F, 1.0F}), 82);
    bench_.pass(5);
    EXPECT_EQ(bench_.fw.phase, FW_LATCHED);
  }
}

TEST_F(Firmware, StaleCommand_IsCountedAndHasNoEffect) {
  render({6.0F, 0.0F, 0.0F});
  commands_ -= 3;
  for (int i = 0; i < 3; ++i) {
    send(WF_COMMAND, 0, {-6.0F, 0.0F, 0.0F});
    bench_.pass(6);
  }
  EXPECT_EQ(bench_.fw.counters.stale, 3U);
  EXPECT_EQ(bench_.given[0], 6.0F);
  bench_.pass(4);
  EXPECT_EQ(bench_.fw.phase, FW_RAMPING) << "22 ms without a new one";
}

TEST_F(Firmware, ForeignSession_IsCountedAndIgnored) {
  render({6.0F, 0.0F, 0.0F});
  send(WF_COMMAND, 0, {-6.0F, 0.0F, 0.0F}, 99);
  send(WF_CONTROL, WH_DISABLE, {}, 99);
  bench_.pass();
  EXPECT_EQ(bench_.fw.counters.foreign, 2U);
  EXPECT_EQ(bench_.given[0], 6.0F);
  EXPECT_EQ(bench_.fw.phase, FW_RENDERING);
}

TEST_F(Firmware, HelloOfASecondProgram_DoesNotCutOffTheRenderingOne) {
  render({6.0F, 0.0F, 0.0F});
  (void)newest(WF_WELCOME);
  send(WF_HELLO, 0, {}, 99);
  bench_.pass();
  EXPECT_EQ(newest(WF_WELCOME).session, kSession);
  EXPECT_EQ(bench_.fw.phase, FW_RENDERING);
  bench_.pass(150);
  send(WF_HELLO, 0, {}, 99);
  bench_.pass();
  EXPECT_EQ(newest(WF_WELCOME).session, 99U) << "the first one fell silent";
}

TEST_F(Firmware, Disable_RampsFirstAndIsAnsweredAfterwards) {
  render({6.0F, -3.0F, 1.0F});
  (void)newest(WF_ANSWER);
  send(WF_CONTROL, WH_DISABLE);
  const int ramp_ms = expectRamp({6.0F, -3.0F, 1.0F});
  EXPECT_LE(ramp_ms, 82);
  EXPECT_EQ(newest(WF_ANSWER).kind, 0) << "not before it is done";
  --questions_;
  send(WF_CONTROL, WH_DISABLE);  // the program repeats the request
  bench_.pass();
  const wf_frame answer = newest(WF_ANSWER);
  EXPECT_EQ(answer.index, WH_DISABLE);
  EXPECT_EQ(answer.result, WH_OK);
  EXPECT_FALSE(bench_.on);
}

TEST_F(Firmware, RepeatedEnable_DropsNoEffort) {
  render({6.0F, 0.0F, 0.0F});
  --questions_;
  send(WF_CONTROL, WH_ENABLE);
  bench_.pass();
  EXPECT_EQ(bench_.given[0], 6.0F);
  EXPECT_EQ(bench_.fw.phase, FW_RENDERING);
}

// The first request is answered; a line may hold back copies of it until the watchdog has let go.
TEST_F(Firmware, LateCopiesOfRequests_ReleaseNoLatchAndActOnce) {
  render({6.0F, 0.0F, 0.0F});
  const std::uint32_t enabled_by = questions_;
  bench_.pass(150);
  ASSERT_EQ(bench_.fw.phase, FW_LATCHED);
  questions_ = 0;
  send(WF_HELLO);
  questions_ = enabled_by - 1;
  send(WF_CONTROL, WH_ENABLE);
  send(WF_COMMAND, 0, {6.0F, 6.0F, 6.0F});
  bench_.pass();
  EXPECT_EQ(bench_.fw.phase, FW_LATCHED);
  EXPECT_EQ(bench_.given[0], 0.0F);
  EXPECT_EQ(newest(WF_ANSWER).sequence, enabled_by) << "it is answered all the same";
  send(WF_CONTROL, WH_IDENTIFY);
  bench_.pass();
  --questions_;
  send(WF_CONTROL, WH_IDENTIFY);
  bench_.pass();
  EXPECT_EQ(bench_.verbs, std::vector<int>{WH_IDENTIFY});
  EXPECT_EQ(newest(WF_ANSWER).result, WH_OK);
}

// For any value of the sequence, including its wrap-around.
TEST_F(Firmware, CommandFromBeforeEnable_IsIgnoredAfterIt) {
  auto random = seededRandom(1212);
  for (int k = 0; k < cases(200); ++k) {
    bench_.pass(150);
    send(WF_HELLO, 0, {}, kSession);
    // Moves the sequence to any value. Half of all numbers count as newer, so it takes two steps.
    send(WF_CONTROL, WH_ENABLE);
    const auto far = static_cast<std::uint32_t>(random() % 0x7f000000U);
    for (const std::uint32_t step : {far, k % 3 == 0 ? 0U - (commands_ + far) - 3U : 1U}) {
      commands_ += step < 0x7f000000U ? step : 0x7f000000U;
      send(WF_COMMAND, 0, {6.0F, 0.0F, 0.0F});
      bench_.pass();
    }
    ASSERT_EQ(bench_.given[0], 6.0F) << commands_;
    const std::uint32_t last = commands_;
    bench_.pass(150);
    send(WF_CONTROL, WH_ENABLE);
    bench_.pass();
    const std::uint32_t next = commands_;
    // Commands received before, on their way during the enable, or held back for seconds.
    for (const std::uint32_t old : {last, last - 3, last + 1, last + 1000, last + 20000}) {
      commands_ = old - 1;
      send(WF_COMMAND, 0, {-6.0F, 0.0F, 0.0F});
      bench_.pass();
      ASSERT_EQ(bench_.given[0], 0.0F) << old;
    }
    commands_ = next;
    send(WF_COMMAND, 0, {1.0F, 0.0F, 0.0F});
    bench_.pass();
    ASSERT_EQ(bench_.given[0], 1.0F) << commands_;
  }
}

TEST_F(Firmware, EnableWithoutCommands_IsWithdrawn) {
  enable();
  bench_.pass(1990);
  EXPECT_EQ(bench_.fw.phase, FW_WAITING);
  bench_.pass(20);
  EXPECT_EQ(bench_.fw.phase, FW_LATCHED);
}

TEST_F(Firmware, DriveFaultOfTheBoard_IsReportedAsNotEnabled) {
  render({1.0F, 0.0F, 0.0F});
  bench_.state.status |= WH_DRIVE_FAULT;
  bench_.state.vendor_code = -7;
  bench_.pass();
  const wf_frame sample = newest(WF_SAMPLE);
  EXPECT_EQ(sample.status & (WH_ENABLED | WH_DRIVE_FAULT),
            static_cast<std::uint32_t>(WH_DRIVE_FAULT));
  EXPECT_EQ(sample.vendor_code, -7);
}

// For any input, no effort is beyond its limit or not finite, and 110 ms of silence end at neutral.
TEST_F(Firmware, RandomFramesAndPauses_NeverPushBeyondTheLimitAndEndAtNeutral) {
  auto random = seededRandom(1211);
  const auto number = [&random] {
    const float some[] = {0.0F,
                          7.9F,
                          -8.1F,
                          1e30F,
                          std::numeric_limits<float>::infinity(),
                          std::numeric_limits<float>::quiet_NaN(),
                          -3.0F,
                          0.5F};
    return some[random() % 8];
  };
  std::uint32_t skipped = 0;
  for (int k = 0; k < cases(20'000); ++k) {
    wf_frame frame{};
    frame.kind =
        static_cast<std::uint8_t>(random() % 3 != 0 ? std::uint64_t{WF_COMMAND} : 1 + random() % 8);
    frame.axes = random() % 20 == 0 ? 2 : 3;
    frame.index = static_cast<std::uint8_t>(random() % 8);
    frame.session = random() % 10 == 0 ? 6 : kSession;
    frame.sequence = static_cast<std::uint32_t>(k) + static_cast<std::uint32_t>(random() % 3);
    if (frame.kind == WF_CONTROL && frame.index == WH_ENABLE) skipped += WF_ENABLE_SKIP;
    if (frame.kind == WF_COMMAND) frame.sequence += skipped;
    for (float& effort : frame.effort) effort = random() % 50 == 0 ? number() : 4.0F;
    put(frame);
    if (random() % 4 == 0) bench_.wires->to_device.push_back(static_cast<std::uint8_t>(random()));
    bench_.pass(random() % 50 == 0 ? 25 : 1);
    for (int i = 0; i < 3; ++i) {
      const float given = bench_.given[i];
      ASSERT_TRUE(std::isfinite(given));
      ASSERT_LE(std::abs(given), 8.0F);
    }
    if (random() % 1000 == 0) {
      bench_.pass(110);
      ASSERT_EQ(bench_.given[0], 0.0F) << k;
    }
  }
}

}  // namespace
}  // namespace wholehand::test
