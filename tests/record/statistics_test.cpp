#include "loop/runtime/statistics.hpp"

#include "loop/core/record_packing.hpp"
#include "record/hub.hpp"
#include "record/recording.hpp"
#include "record/synthetic_recording.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace wholehand {
namespace {

/// The exact answer: the nearest rank in the sorted samples.
double nearestRank(std::vector<std::int64_t> samples, double share) {
  std::sort(samples.begin(), samples.end());
  const double rank = std::ceil(share * static_cast<double>(samples.size()));
  return static_cast<double>(samples[static_cast<std::size_t>(std::max(rank, 1.0)) - 1]);
}

TEST(DurationHistogram, LogNormalDurations_PercentilesAreWithinOnePercentOfSorted) {
  std::mt19937_64 random(7);
  std::lognormal_distribution<double> us(std::log(40.0), 0.7);
  DurationHistogram histogram;
  std::vector<std::int64_t> samples;
  for (int i = 0; i < 50000; ++i) {
    samples.push_back(static_cast<std::int64_t>(us(random) * 1000.0));
    histogram.add(samples.back());
  }
  for (const double share : {0.001, 0.25, 0.5, 0.9, 0.99, 0.999, 1.0}) {
    const double exact = nearestRank(samples, share);
    EXPECT_NEAR(histogram.quantile(share), exact, 0.01 * exact) << share;
  }
  EXPECT_EQ(histogram.percentiles().max_ns, nearestRank(samples, 1.0));  // exact
}

TEST(DurationHistogram, OneOrNoDuration_IsExact) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0.0);
  histogram.add(12345);
  EXPECT_EQ(histogram.quantile(0.5), 12345.0);
  EXPECT_EQ(histogram.percentiles().p999_ns, 12345.0);
}

TEST(TickStatistics, NoisyRecords_MatchDirectCounts) {
  std::mt19937_64 random(3);
  TickStatistics statistics;
  std::uint64_t ticks = 0, missed = 0, limited = 0;
  std::int32_t contacts = 0;
  double most = 0.0, error = 0.0;
  std::vector<std::int64_t> cpu, stage;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const TickRecord r = synthetic::noisy(i, random);
    statistics.add(r);
    ticks += r.elapsed_periods;
    missed += r.elapsed_periods - 1;
    limited += any(r.faults & Fault::kEffortLimit) ? 1 : 0;
    contacts = std::max(contacts, r.contact_count + r.contacts_dropped);
    most = std::max(most, std::abs(r.sent[5]));
    error = std::max(error, std::abs(r.coupling_error_rad));
    cpu.push_back(r.cpu_ns);
    stage.push_back(r.stage_cpu_ns[2]);
  }
  const TickSummary s = statistics.snapshot();
  EXPECT_EQ(s.records, 5000U);
  EXPECT_EQ(s.ticks, ticks);
  EXPECT_EQ(s.missed_deadlines, missed);
  EXPECT_EQ(missed, 100U);  // the synthetic recording skips one period in fifty
  EXPECT_EQ(s.faults[6], limited);
  EXPECT_EQ(s.contacts_max, contacts);
  EXPECT_EQ(s.max_effort[5], most);
  EXPECT_EQ(s.max_coupling_error_rad, error);
  EXPECT_NEAR(s.cpu.p99_ns, nearestRank(cpu, 0.99), 0.01 * nearestRank(cpu, 0.99));
  EXPECT_NEAR(s.stage_cpu[2].p50_ns, nearestRank(stage, 0.5), 0.01 * nearestRank(stage, 0.5));
}

// A spring of 100 N/m that is pushed in by 2 cm takes 20 mJ from the person, and gives them back.
TEST(TickStatistics, WorkOfASpring_IsItsEnergyBothWays) {
  TickStatistics statistics;
  constexpr double kStiffness = 100.0, kDeep = 0.02;
  const auto move = [&](double from, double to) {
    for (int k = 0; k <= 1000; ++k) {
      TickRecord r;
      r.q_m = AxisPosition(1, from + (to - from) * k / 1000.0);
      r.sent = AxisEffort(1, -kStiffness * r.q_m[0]);
      statistics.add(r);
    }
  };
  move(0.0, kDeep);
  const double pushed_in_j = statistics.snapshot().work_j;
  EXPECT_NEAR(pushed_in_j, -0.5 * kStiffness * kDeep * kDeep, 1e-4);
  move(kDeep, 0.0);
  EXPECT_NEAR(statistics.snapshot().work_j, 0.0, 1e-4);
}

TEST(TickStatistics, FaultsOfAnAxis_AreCountedForThatAxis) {
  TickStatistics statistics;
  const auto tick = [&statistics](Fault faults, int axis) {
    TickRecord r;
    r.faults = faults;
    r.fault_axis = axis;
    statistics.add(r);
  };
  for (int i = 0; i < 3; ++i) tick(Fault::kEffortLimit, 4);
  tick(Fault::kEffortLimit | Fault::kLateTick, 5);
  tick(Fault::kEffortLimit | Fault::kEffortSlew, 2);  // the limit comes first in the tick
  tick(Fault::kEffortLimit | Fault::kSpeedLimit, 1);  // the device is read before both
  tick(Fault::kWorkspace | Fault::kNonFiniteEffort, 0);
  tick(Fault::kLateTick | Fault::kDeviceRead, -1);
  const TickSummary s = statistics.snapshot();
  EXPECT_EQ(s.faults[6], 6U);  // the bits of loop/core/fault.hpp
  std::array<std::uint64_t, kMaxAxes> limited{}, none{}, slow{}, broken{};
  limited[4] = 3;
  limited[5] = limited[2] = slow[1] = broken[0] = 1;
  EXPECT_EQ(s.fault_axes[6], limited);
  EXPECT_EQ(s.fault_axes[15], none);  // slew
  EXPECT_EQ(s.fault_axes[12], slow);
  EXPECT_EQ(s.fault_axes[3], broken);
  EXPECT_EQ(s.fault_axes[13], none);  // workspace
  EXPECT_EQ(s.fault_axes[7], none);   // lateness has no axis
  EXPECT_EQ(s.fault_axes[0], none);
}

/// The source of a hub: gives as many ticks as `offered`, then none.
template <class Count>
auto noisySource(const Count& offered) {
  return [&offered, next = std::uint64_t{0}, random = std::mt19937_64(1)](TickRecord& r) mutable {
    if (next >= offered) return false;
    r = synthetic::noisy(next++, random);
    return true;
  };
}

TEST(TelemetryHub, StopAfterABurst_EverySinkHasEveryRecord) {
  const synthetic::Folder folder;
  auto writer = RecordingWriter::create(folder.file("a.h5"), synthetic::meta()).value();
  TickStatistics statistics;
  std::atomic<std::uint64_t> offered{0};
  TelemetryHub hub(noisySource(offered));
  std::vector<std::uint64_t> seen;
  hub.record(*writer);
  hub.count(statistics);
  hub.add([&seen](const TickRecord& r) { seen.push_back(r.tick); });
  hub.start();
  for (int i = 0; i < 20; ++i) {
    offered += 37;
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
    EXPECT_LE(statistics.snapshot().records, 740U);  // from another thread
  }
  offered += 263;
  hub.stop();
  EXPECT_EQ(statistics.snapshot().records, 1003U);
  ASSERT_EQ(seen.size(), 1003U);
  for (std::uint64_t i = 0; i < seen.size(); ++i) ASSERT_EQ(seen[i], i);
  EXPECT_EQ(writer->written(), 1003U);  // flushed, although not yet closed
}

/// Keeps only the number of ticks.
class CountingRecorder : public RecordingWriter {
 public:
  bool append(const TickRecord&) override {
    ++written_;
    return true;
  }
  void flush() override {}
  void close() override {}
  [[nodiscard]] std::uint64_t written() const override { return written_; }
  [[nodiscard]] std::uint64_t dropped() const override { return 0; }
  [[nodiscard]] std::uint64_t bytes() const override { return 0; }

 private:
  std::uint64_t written_ = 0;
};

/// A disk whose driver throws at one tick.
class BrokenRecorder final : public CountingRecorder {
 public:
  bool append(const TickRecord& record) override {
    if (record.tick == 10) throw std::bad_alloc();
    return CountingRecorder::append(record);
  }
};

constexpr std::uint64_t kHundred = 100;

TEST(TelemetryHub, ConsumersThatThrow_AreReportedAndNotCalledAgain) {
  BrokenRecorder recorder;
  TickStatistics statistics;
  TelemetryHub hub(noisySource(kHundred));
  int before = 0, after = 0, good = 0;
  hub.record(recorder);
  hub.count(statistics);
  hub.add([&](const TickRecord& r) {
    ++before;
    if (r.tick == 20) throw std::runtime_error("no more paper");
  });
  hub.add([&](const TickRecord&) {
    ++after;
    throw 7;
  });
  hub.add([&](const TickRecord&) { ++good; });
  hub.start();
  hub.stop();
  EXPECT_EQ(statistics.snapshot().records, 100U);
  EXPECT_EQ(good, 100);
  EXPECT_EQ(before, 21);  // 0 to 20
  EXPECT_EQ(after, 1);
  EXPECT_EQ(recorder.written(), 10U);  // 0 to 9
  EXPECT_EQ(hub.unrecorded(), 90U);
  std::vector<std::string> failures = hub.failures();
  std::sort(failures.begin(), failures.end());  // the recorder has its own thread
  ASSERT_EQ(failures.size(), 3U);
  EXPECT_EQ(failures[0], "sink 1 threw: no more paper");
  EXPECT_EQ(failures[1], "sink 2 threw: something that is no std::exception");
  EXPECT_EQ(failures[2], std::string("the recorder threw: ") + std::bad_alloc().what());
}

/// A disk that hangs from its first tick on until it is released.
class HungRecorder final : public CountingRecorder {
 public:
  bool append(const TickRecord& record) override {
    go_.wait(false);
    return CountingRecorder::append(record);
  }
  void answer() {
    go_ = true;
    go_.notify_all();
  }

 private:
  std::atomic<bool> go_{false};
};

TEST(TelemetryHub, DiskThatHangs_BlocksNobodyAndItsLossIsReported) {
  constexpr std::uint64_t kTicks = 2000;
  HungRecorder recorder;
  std::uint64_t next = 0;
  std::mt19937_64 random(1);
  TickRecord tick = synthetic::noisy(0, random);
  tick.body_count = kMaxBodies;
  tick.contact_count = kMaxContacts;
  std::vector<std::byte> packed(kMostPackedBytes);
  const std::uint64_t room = (std::size_t{24} << 20U) / packRecord(tick, packed.data());
  ASSERT_LT(room, kTicks - 100);
  TelemetryHub hub([&](TickRecord& r) {
    if (next >= kTicks) return false;
    r = tick;
    r.tick = next++;
    return true;
  });
  std::atomic<std::uint64_t> seen{0};
  hub.record(recorder);
  hub.add([&](const TickRecord&) { ++seen; });
  hub.start();
  for (int i = 0; i < 20'000 && seen < kTicks; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(seen, kTicks) << "pages and games see every tick";
  EXPECT_GE(hub.unrecorded(), kTicks - room - 1) << "24 MB wait, and one is being written";
  recorder.answer();
  hub.stop();
  EXPECT_EQ(recorder.written() + hub.unrecorded(), kTicks);
  EXPECT_GE(recorder.written(), room - 5);
}

TEST(TelemetryHub, SourceThatThrows_EndsTheHubAndIsReported) {
  TelemetryHub hub([](TickRecord&) -> bool { throw std::runtime_error("gone"); });
  hub.start();
  hub.stop();
  ASSERT_EQ(hub.failures().size(), 1U);
  EXPECT_EQ(hub.failures()[0], "the source threw: gone");
}

}  // namespace
}  // namespace wholehand
