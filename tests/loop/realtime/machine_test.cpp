#include "loop/realtime/machine_facts.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace wholehand {
namespace {

TEST(RealTimeKernel, SysFileOrVersionText_IsSufficient) {
  EXPECT_TRUE(isRealTimeKernel("1", "#1 SMP"));
  EXPECT_TRUE(isRealTimeKernel("", "#1 SMP PREEMPT_RT Debian 6.1.106-3"));
  EXPECT_TRUE(isRealTimeKernel("", "#8 SMP PREEMPT RT Thu"));  // older patches
  EXPECT_FALSE(isRealTimeKernel("0", "#1 SMP"));
  // Most stock kernels say this; they are not real-time kernels.
  EXPECT_FALSE(isRealTimeKernel("", "#1 SMP PREEMPT_DYNAMIC Debian 6.1.106-3"));
}

TEST(MachineFacts, ThisMachine_IsReported) {
  const MachineFacts facts = machineFacts();
  EXPECT_FALSE(facts.kernel.empty());
  EXPECT_GE(facts.cpus_allowed, 1);
  EXPECT_GE(facts.cpus_online, facts.cpus_allowed);
}

TEST(WakeUpStatistics, OneToAThousand_GiveTheNearestRanks) {
  std::vector<std::int64_t> samples(1000);
  std::iota(samples.rbegin(), samples.rend(), 1);  // 1000 … 1: unsorted on purpose
  const WakeUpStatistics s = wakeUpStatistics(samples);
  EXPECT_EQ(s.wake_ups, 1000U);
  EXPECT_EQ(s.p50_ns, 500);  // closed form: rank ⌈p n⌉
  EXPECT_EQ(s.p99_ns, 990);
  EXPECT_EQ(s.p999_ns, 999);
  EXPECT_EQ(s.max_ns, 1000);
}

TEST(WakeUpStatistics, LatenessClasses_HoldEverySampleOnce) {
  // One sample on each upper bound, which belongs to the next class, and one below all.
  std::vector<std::int64_t> samples(kLatenessClass_ns.begin(), kLatenessClass_ns.end());
  samples.push_back(0);
  const WakeUpStatistics s = wakeUpStatistics(samples);
  for (const std::uint64_t count : s.classes) EXPECT_EQ(count, 1U);
}

TEST(WakeUpStatistics, OneSample_IsEveryPercentile) {
  std::vector<std::int64_t> samples{7};
  const WakeUpStatistics s = wakeUpStatistics(samples);
  EXPECT_EQ(s.p50_ns, 7);
  EXPECT_EQ(s.p999_ns, 7);
  EXPECT_EQ(wakeUpStatistics({}).wake_ups, 0U);
}

TEST(WakeUpProbe, HundredPeriods_GiveHundredWakeUpsAndTheSetup) {
  std::size_t reported = 0, last = 0;
  const auto probe = probeWakeUps({}, 100, [&](std::size_t done) {
    ++reported;
    EXPECT_GE(done, last);
    last = done;
  });
  ASSERT_TRUE(probe.ok());
  EXPECT_EQ(probe.value().statistics.wake_ups, 100U);
  EXPECT_GT(probe.value().statistics.max_ns, 0);
  EXPECT_GE(probe.value().statistics.max_ns, probe.value().statistics.p50_ns);
  EXPECT_FALSE(probe.value().setup.empty());
  EXPECT_GE(reported, 1U);
  EXPECT_LE(last, 100U);
}

}  // namespace
}  // namespace wholehand
