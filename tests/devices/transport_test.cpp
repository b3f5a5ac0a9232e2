// The times between loop and drive, from samples and commands whose times are known.
#include "devices/plugin/transport.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace wholehand::test {
namespace {

constexpr std::int64_t kMs_ns = 1'000'000;

/// An ideal host: at every cycle it reads a fresh sample and passes on the newest command.
TransportLog behindHost(std::int64_t cycle_ns, std::int64_t loop_ns, int ticks) {
  TransportLog log(static_cast<double>(loop_ns) * 1e-9);
  for (std::int64_t n = 1; n <= ticks; ++n) {
    const std::int64_t now_ns = n * loop_ns + kMs_ns / 3;
    const std::int64_t cycle = now_ns / cycle_ns;
    wh_sample sample{};
    sample.sequence = static_cast<std::uint64_t>(cycle);
    sample.monotonic_ns = cycle * cycle_ns;
    // The newest command that was sent before the cycle, and the first cycle after it.
    const std::int64_t taken = (sample.monotonic_ns - kMs_ns / 3) / loop_ns;
    const std::int64_t sent_ns = taken * loop_ns + kMs_ns / 3;
    const std::int64_t arrived_ns = (sent_ns + cycle_ns - 1) / cycle_ns * cycle_ns;
    const WayTimes way{sample.monotonic_ns, static_cast<std::uint64_t>(taken), sent_ns, arrived_ns};
    log.add(sample, way, now_ns);
  }
  return log;
}

// Each way takes up to a cycle of the host, which device-host.md adds to the delay.
TEST(Transport, HostOfAnyRate_TakesUpToACycleEachWay) {
  for (const std::int64_t cycle_ns : {kMs_ns, kMs_ns / 2, kMs_ns / 4}) {
    const Transport found = behindHost(cycle_ns, 923'000, 20'000).within(kTransportShare);
    const double cycle_s = static_cast<double>(cycle_ns) * 1e-9;
    EXPECT_LE(found.up_s, cycle_s);
    EXPECT_GT(found.up_s, 0.98 * cycle_s);
    EXPECT_LE(found.down_s, cycle_s + 1e-9);
    EXPECT_GT(found.down_s, 0.98 * cycle_s);
  }
}

// Three of four commands are replaced on the way. Without counting them the way down would seem to
// take a quarter of a cycle at most.
TEST(Transport, CommandsThatAHostNeverTakes_CountForTheOnesAfterThem) {
  const Transport found = behindHost(kMs_ns, 249'000, 20'000).within(kTransportShare);
  EXPECT_GT(found.down_s, 0.95e-3);
  EXPECT_LE(found.down_s, 1.0e-3 + 1e-9);
}

TEST(Transport, OneLateMessageOfAThousand_IsLeftOutAndTheSecondCounts) {
  for (const int late : {1, 2}) {
    TransportLog log(1e-3);
    for (int n = 1; n <= 1000; ++n) {
      const std::int64_t now_ns = n * kMs_ns;
      wh_sample sample{};
      sample.sequence = static_cast<std::uint64_t>(n);
      sample.monotonic_ns = now_ns - (n <= late ? 7 * kMs_ns : kMs_ns / 5);
      log.add(sample, {}, now_ns);
    }
    const Transport found = log.within(kTransportShare);
    EXPECT_NEAR(found.up_s, late == 1 ? 0.2e-3 : 7e-3, 1e-12);
    EXPECT_EQ(found.down_s, 0.0) << "the loop calls the driver itself";
    EXPECT_NEAR(log.within(0.5).up_s, 0.2e-3, 1e-12);
  }
}

// Some drives give a sample only once they get commands: the age of their old one says nothing.
TEST(Transport, DriveWithoutNewSamples_CountsFromTheCallOfItsDriver) {
  TransportLog direct(1e-3), hosted(1e-3);
  wh_sample old{};
  old.sequence = 7;
  old.monotonic_ns = kMs_ns;
  for (int n = 1; n <= 1000; ++n) {
    const std::int64_t now_ns = (100 + n) * kMs_ns;
    direct.add(old, {}, now_ns);
    hosted.add(old, {now_ns - kMs_ns / 4, 0, 0, 0}, now_ns);
  }
  EXPECT_EQ(direct.within(kTransportShare).both_s(), 0.0);
  EXPECT_NEAR(hosted.within(kTransportShare).both_s(), 0.25e-3, 1e-12);
}

TEST(Transport, CommandFromBeforeTheMeasurement_IsNotCounted) {
  TransportLog log(1e-3);
  wh_sample sample{};
  log.add(sample, {kMs_ns, 40, kMs_ns, 90 * kMs_ns}, 100 * kMs_ns);
  EXPECT_EQ(log.commands(), 0U);
  log.add(sample, {101 * kMs_ns, 1, 100 * kMs_ns, 100 * kMs_ns + kMs_ns / 2}, 101 * kMs_ns);
  EXPECT_EQ(log.commands(), 1U) << "a new session counts from 1";
  EXPECT_NEAR(log.within(1.0).down_s, 0.5e-3, 1e-12);
}

}  // namespace
}  // namespace wholehand::test
