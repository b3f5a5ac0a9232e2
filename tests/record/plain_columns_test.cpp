// Content of a recorded tick: inputs to the bit, all other numbers in single precision, and a
// digest.
#include "loop/core/tick_digest.hpp"
#include "record/round_trip.hpp"
#include "support/seed.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

using synthetic::noisyTicks;

/// All numbers of a tick that its digest covers, in order.
std::vector<double> computed(const TickRecord& record) {
  std::vector<double> numbers;
  visitComputed(record, [&numbers](const char*, const double* from, int count) {
    numbers.insert(numbers.end(), from, from + count);
  });
  return numbers;
}

std::vector<std::uint64_t> bits(const auto& numbers) {
  std::vector<std::uint64_t> out;
  for (const double v : numbers) out.push_back(std::bit_cast<std::uint64_t>(v));
  return out;
}

TEST(PlainColumns, Inputs_AreRestoredToTheBit) {
  synthetic::roundTrip(noisyTicks(synthetic::kManyTicks),
                       [](const TickRecord& wrote, const TickRecord& read) {
                         EXPECT_EQ(read.tick, wrote.tick);
                         EXPECT_EQ(read.elapsed_periods, wrote.elapsed_periods);
                         EXPECT_EQ(read.faults, wrote.faults);
                         EXPECT_EQ(read.moved_by, wrote.moved_by);
                         EXPECT_EQ(read.help, wrote.help);
                         EXPECT_EQ(bits(std::vector{read.time_s}), bits(std::vector{wrote.time_s}));
                         EXPECT_EQ(bits(read.q_m), bits(wrote.q_m));
                         EXPECT_EQ(bits(read.parameters), bits(wrote.parameters));
                         ASSERT_EQ(read.command_count, wrote.command_count);
                         for (int c = 0; c < wrote.command_count; ++c) {
                           const Command &a = read.commands[c], &b = wrote.commands[c];
                           EXPECT_EQ(a.type, b.type);
                           EXPECT_EQ(a.index, b.index);
                           EXPECT_EQ(bits(std::vector{a.value}), bits(std::vector{b.value}));
                           EXPECT_EQ(bits(a.aim), bits(b.aim));
                         }
                       });
}

// The bound is half the spacing of single precision numbers, IEEE 754: 2⁻²⁴ relative.
TEST(PlainColumns, OtherNumbers_AreRoundedToSinglePrecision) {
  synthetic::roundTrip(noisyTicks(synthetic::kManyTicks),
                       [](const TickRecord& wrote, const TickRecord& read) {
                         const std::vector<double> a = computed(wrote), b = computed(read);
                         ASSERT_EQ(a.size(), b.size()) << "an array has another length";
                         for (std::size_t i = 0; i < a.size(); ++i) {
                           if (std::isnan(a[i]) || std::isinf(a[i])) {
                             EXPECT_TRUE(std::isnan(a[i]) ? std::isnan(b[i]) : a[i] == b[i]) << i;
                           } else {
                             EXPECT_LE(std::abs(a[i] - b[i]), 0x1p-24 * std::abs(a[i])) << i;
                           }
                         }
                         EXPECT_EQ(read.intention.size(), wrote.intention.size());
                         EXPECT_EQ(read.patient_effort.size(), wrote.patient_effort.size());
                       });
}

TEST(PlainColumns, Digest_IsThatOfTheUnroundedTick) {
  const test::Folder folder;
  const std::string path = folder.file("a.h5");
  const auto ticks = noisyTicks(300);
  synthetic::writeRecording(path, ticks);
  const auto reader = RecordingReader::open(path).value();
  TickRecord read;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    ASSERT_TRUE(reader->read(i, read));
    EXPECT_EQ(reader->digest(), digestOf(ticks[i])) << i;
  }
}

// Any changed bit of any computed number changes the digest; a NaN's payload does not.
TEST(TickDigest, OneChangedBit_ChangesTheDigest) {
  std::mt19937_64 random(test::seed());
  for (int i = 0; i < test::cases(2000); ++i) {
    TickRecord record = synthetic::noisy(i, random);
    std::vector<const double*> numbers;
    visitComputed(record, [&](const char*, const double* from, int count) {
      const auto* begin = reinterpret_cast<const std::byte*>(&record);
      const auto* at = reinterpret_cast<const std::byte*>(from);
      if (at < begin || at >= begin + sizeof record) return;  // a copy of an integer
      for (int k = 0; k < count; ++k) numbers.push_back(from + k);
    });
    auto* number = const_cast<double*>(numbers[random() % numbers.size()]);
    const std::uint64_t before = digestOf(record);
    const bool was_nan = std::isnan(*number);
    const auto flipped =
        std::bit_cast<std::uint64_t>(*number) ^ (std::uint64_t{1} << random() % 64);
    *number = std::bit_cast<double>(flipped);
    if (was_nan && std::isnan(*number)) {
      EXPECT_EQ(digestOf(record), before);
    } else {
      EXPECT_NE(digestOf(record), before);
    }
  }
}

TEST(TickDigest, ClockTimesAndTheVirtualPatient_AreNotCovered) {
  std::mt19937_64 random(test::seed());
  TickRecord record = synthetic::noisy(7, random);
  const std::uint64_t before = digestOf(record);
  record.wall_ns += 1;
  record.cpu_ns += 1;
  record.lateness_ns += 1;
  record.stage_cpu_ns.fill(3);
  record.intention = AxisPosition(6);
  record.patient_effort = AxisEffort(6);
  record.moved_by = Mover::kMotion;
  record.help = Help::kSome;
  EXPECT_EQ(digestOf(record), before);
  record.bodies[static_cast<std::size_t>(record.body_count)].position_m.x = 1.0;  // unused
  EXPECT_EQ(digestOf(record), before);
}

}  // namespace
}  // namespace wholehand
