#include "loop/realtime/periodic_thread.hpp"

#include "loop/realtime/monotonic_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <thread>
#include <time.h>
#include <vector>

namespace wholehand {
namespace {

constexpr std::int64_t kMs_ns = 1'000'000;

// Closed form throughout: slots begin at 100 ms + n · 1 ms.
void expectSlotAt101(std::int64_t woken_ns) {
  const Slot slot = slotAt(woken_ns, 100 * kMs_ns, kMs_ns);
  EXPECT_EQ(slot.start_ns, 101 * kMs_ns);
  EXPECT_EQ(slot.elapsed_periods, 1U);
}

TEST(SlotAt, WokenInTime_IsTheNextSlot) {
  expectSlotAt101(101 * kMs_ns + 50'000);
}

TEST(SlotAt, WokenTooEarly_IsStillTheNextSlot) {
  expectSlotAt101(100 * kMs_ns + 999'999);
}

TEST(SlotAt, LateByLessThanAPeriod_LosesNoTick) {
  expectSlotAt101(101 * kMs_ns + 999'999);
}

TEST(SlotAt, StalledForManyPeriods_SkipsThemAndKeepsThePhase) {
  const Slot slot = slotAt(107 * kMs_ns + 300'000, 100 * kMs_ns, kMs_ns);
  EXPECT_EQ(slot.start_ns, 107 * kMs_ns);  // in phase with the slots, not the present time
  EXPECT_EQ(slot.elapsed_periods, 7U);     // this tick and six skipped
  const Slot next = slotAt(108 * kMs_ns + 10, slot.start_ns, kMs_ns);
  EXPECT_EQ(next.elapsed_periods, 1U);  // no burst: skipped periods stay skipped
}

TEST(SlotAt, AnyWakeUps_CountEveryPeriodOnce) {
  // Ticks plus skipped periods are the elapsed periods, for any jitter.
  std::int64_t last_ns = 0;
  std::int64_t now_ns = 0;
  std::uint64_t total = 0;
  std::uint32_t noise = 12345;
  for (int i = 0; i < 10'000; ++i) {
    noise = noise * 1664525U + 1013904223U;
    const std::int64_t due_ns = last_ns + kMs_ns;
    now_ns = (now_ns > due_ns ? now_ns : due_ns) + (noise >> 11U);  // 0 … 2.1 ms late
    const Slot slot = slotAt(now_ns, last_ns, kMs_ns);
    ASSERT_LE(slot.start_ns, now_ns);
    ASSERT_LT(now_ns - slot.start_ns, kMs_ns);
    total += slot.elapsed_periods;
    last_ns = slot.start_ns;
  }
  EXPECT_EQ(static_cast<std::int64_t>(total), last_ns / kMs_ns);
}

TEST(PeriodicThread, Thread_RunsUntilTheTickReturnsFalse) {
  std::atomic<int> ticks{0};
  PeriodicThread thread({}, [&](std::uint32_t, std::int64_t) { return ++ticks < 20; });
  const auto report = thread.start();
  ASSERT_TRUE(report.ok());
  thread.join();
  EXPECT_EQ(ticks, 20);
  EXPECT_FALSE(thread.running());
}

// A loop that counts from its wake-up time would drift by the wake-up latency of every period.
TEST(PeriodicThread, Periods_FollowTheClockWithoutDrift) {
  constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  std::uint64_t periods = 0;
  std::int64_t early_ns = kNever;
  std::int64_t late_ns = kNever;
  bool negative_lateness = false;
  PeriodicThread thread({}, [&](std::uint32_t elapsed, std::int64_t lateness_ns) {
    negative_lateness = negative_lateness || lateness_ns < 0;
    // Start of the slots, to the time between two readings of the clock. A preemption between them
    // only adds to it, so the smallest one counts.
    const std::int64_t due_ns = monotonicNow_ns() - lateness_ns;
    std::int64_t& least_ns = periods < 100 ? early_ns : late_ns;
    least_ns = std::min(least_ns, due_ns - static_cast<std::int64_t>(periods) * kMs_ns);
    periods += elapsed;
    return periods < 300;
  });
  ASSERT_TRUE(thread.start().ok());
  thread.join();
  EXPECT_FALSE(negative_lateness);
  ASSERT_NE(early_ns, kNever);
  ASSERT_NE(late_ns, kNever);
  EXPECT_NEAR(early_ns, late_ns, kMs_ns / 2);
}

TEST(PeriodicThread, TickLongerThanPeriods_SkipsAndCountsThem) {
  std::vector<std::uint32_t> elapsed_periods;
  std::vector<std::int64_t> lateness_ns;
  elapsed_periods.reserve(8);
  lateness_ns.reserve(8);
  PeriodicThread thread({}, [&](std::uint32_t elapsed, std::int64_t late) {
    elapsed_periods.push_back(elapsed);
    lateness_ns.push_back(late);
    if (elapsed_periods.size() == 2) {
      const std::int64_t until_ns = monotonicNow_ns() + 5 * kMs_ns + kMs_ns / 2;
      while (monotonicNow_ns() < until_ns) {
      }
    }
    return elapsed_periods.size() < 4;
  });
  ASSERT_TRUE(thread.start().ok());
  thread.join();
  ASSERT_EQ(elapsed_periods.size(), 4U);
  // 5.5 ms of work from the beginning of a slot end in the fifth slot after it: 4 are skipped.
  EXPECT_GE(elapsed_periods[2], 5U);
  EXPECT_GE(lateness_ns[2], 4 * kMs_ns);
}

TEST(PeriodicThread, DestroyedWhileRunning_EndsAndJoins) {
  std::atomic<int> ticks{0};
  {
    PeriodicThread thread({}, [&](std::uint32_t, std::int64_t) { return ++ticks > 0; });
    ASSERT_TRUE(thread.start().ok());
    while (ticks < 2) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  const int after = ticks;
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(ticks, after);
}

TEST(PeriodicThread, BadPeriodAndStack_AreBothReported) {
  PeriodicThreadConfig config;
  config.period_ns = 0;
  config.stack_bytes = 1;
  PeriodicThread thread(config, [](std::uint32_t, std::int64_t) { return false; });
  const auto report = thread.start();
  ASSERT_FALSE(report.ok());
  ASSERT_EQ(report.errors().size(), 2U);
  EXPECT_EQ(report.errors()[0].key, "period_ns");
  EXPECT_EQ(report.errors()[1].key, "stack_bytes");
}

}  // namespace
}  // namespace wholehand
