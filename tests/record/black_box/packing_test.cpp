#include "loop/core/record_packing.hpp"
#include "record/black_box/box_tools.hpp"
#include "record/input_log.hpp"
#include "support/seed.hpp"

#include <array>
#include <bit>
#include <limits>

namespace wholehand::test {

// Uses the packing itself; PackedRecord compares it with the records field by field.
std::string bytesOf(const TickRecord& record) {
  std::string bytes(kMostPackedBytes, '\0');
  bytes.resize(packRecord(record, reinterpret_cast<std::byte*>(bytes.data())));
  return bytes;
}

namespace {

using Buffer = std::array<std::byte, kMostPackedBytes>;

/// A record whose padding is zero, so that whole records can be compared byte by byte.
TickRecord withoutPadding(const TickRecord& record) {
  TickRecord copy = record;
  const auto clear = [&copy](std::size_t last, std::size_t next) {
    last += sizeof(std::int32_t);
    std::memset(reinterpret_cast<char*>(&copy) + last, 0, next - last);
  };
  clear(offsetof(TickRecord, fault_axis), offsetof(TickRecord, commands));
  clear(offsetof(TickRecord, body_joint_count), offsetof(TickRecord, body_q));
  return copy;
}

TEST(PackedRecord, EveryField_IsRestoredBitForBit) {
  auto random = seededRandom(4101);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const TickRecord want = withoutPadding(tickAt(i, random));
    Buffer packed;
    const std::size_t bytes = packRecord(want, packed.data());
    EXPECT_LE(bytes, kMostPackedBytes);
    TickRecord got;
    ASSERT_TRUE(unpackRecord(packed.data(), bytes, got));
    got = withoutPadding(got);
    ASSERT_EQ(std::memcmp(&want, &got, sizeof want), 0) << "tick " << i;
  }
}

TEST(PackedRecord, LargestTick_Fits) {
  TickRecord full;
  full.command_count = kMaxCommands;
  full.parameter_count = kMaxLiveParameters;
  full.body_count = kMaxBodies;
  full.body_joint_count = kMaxBodies;
  full.contact_count = kMaxContacts;
  full.exercise.value_count = kMaxExerciseValues;
  full.exercise.event_count = kMaxExerciseEvents;
  full.placements.count = kMaxPlacements;
  full.q_m = AxisPosition(kMaxAxes, 1.0);
  full.theta = JointPosition(kMaxJoints, 1.0);
  Buffer packed;
  EXPECT_LE(packRecord(full, packed.data()), kMostPackedBytes);
}

TEST(PackedRecord, TruncatedOrCorrupted_IsRefusedOrStaysWithinItsBounds) {
  auto random = seededRandom(4102);
  const TickRecord want = tickAt(40, random);
  Buffer packed;
  const std::size_t bytes = packRecord(want, packed.data());
  TickRecord got;
  for (std::size_t cut = 0; cut < bytes; ++cut) {
    ASSERT_FALSE(unpackRecord(packed.data(), cut, got)) << cut;
  }
  for (int trial = 0; trial < 20'000; ++trial) {
    Buffer corrupted = packed;
    corrupted[random() % bytes] = static_cast<std::byte>(random());
    if (!unpackRecord(corrupted.data(), bytes, got)) continue;
    ASSERT_TRUE(got.body_count >= 0 && got.body_count <= kMaxBodies);
    ASSERT_TRUE(got.contact_count >= 0 && got.contact_count <= kMaxContacts);
    ASSERT_TRUE(got.q_m.size() >= 0 && got.q_m.size() <= kMaxAxes);
  }
}

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// Writes ticks to a log and reads them back.
class InputLog : public testing::Test {
 protected:
  void SetUp() override {
    for (InputLogState* state : {&writing_, &reading_}) {
      state->encoder_step = AxisPosition(6);
      for (int i = 0; i < 6; ++i) {
        state->encoder_step[i] = encoderSteps()[i];
      }
    }
  }
  /// Writes and reads a record. @return its size in the log [bytes]
  std::size_t expectComesBack(const TickRecord& record) {
    std::array<std::byte, kMostInputBytes> bytes;
    const std::size_t written = logInput(writing_, record, bytes.data());
    EXPECT_LE(written, kMostInputBytes);
    TickInput input;
    EXPECT_EQ(readInput(reading_, bytes.data(), written, input), written);
    EXPECT_EQ(input.elapsed_periods, record.elapsed_periods);
    EXPECT_EQ(input.faults, record.faults & kInputFaults);
    EXPECT_EQ(input.q_m.size(), record.q_m.size());
    for (int i = 0; i < record.q_m.size(); ++i) {
      EXPECT_TRUE(sameBits(input.q_m[i], record.q_m[i])) << "axis " << i << ": " << record.q_m[i];
    }
    EXPECT_EQ(input.command_count, record.command_count);
    for (int i = 0; i < record.command_count; ++i) {
      const Command& want = record.commands[i];
      const Command& got = input.commands[i];
      EXPECT_EQ(got.type, want.type);
      EXPECT_EQ(got.index, want.index);
      EXPECT_TRUE(sameBits(got.value, want.value));
      EXPECT_EQ(got.aim.size(), want.aim.size());
      for (int a = 0; a < want.aim.size(); ++a) EXPECT_TRUE(sameBits(got.aim[a], want.aim[a]));
      for (int n = 0; n < kOrderNumbers; ++n) {
        EXPECT_TRUE(sameBits(got.numbers[n], want.numbers[n])) << "number " << n;
      }
    }
    return written;
  }
  InputLogState writing_, reading_;
};

TEST_F(InputLog, CommandsToBodies_AreRestoredBitForBitWithoutTrailingZeros) {
  TickRecord record;
  record.elapsed_periods = 1;
  record.q_m = AxisPosition(6);
  const std::size_t nothing = expectComesBack(record);
  record.command_count = kMaxCommands;
  for (Command& c : record.commands) {
    c.type = CommandType::kBodyTarget;
    c.index = 63;
    c.value = 1e6;
    c.numbers = {0.1, -0.0, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0, -0.0};
  }
  const std::size_t targets = expectComesBack(record);
  // Six of sixteen numbers, and less than 16 bytes of type, slot, generation and sizes each.
  EXPECT_LT(targets, nothing + kMaxCommands * (6 * sizeof(double) + 16));
  for (Command& c : record.commands) c.numbers.fill(0.1);
  EXPECT_GT(expectComesBack(record), kMaxCommands * kOrderNumbers * sizeof(double));
}

TEST_F(InputLog, AnyTick_IsRestoredBitForBit) {
  auto random = seededRandom(4103);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    TickRecord record = tickAt(i, random);
    record.faults = static_cast<Fault>(random() % (1ULL << kFaultBits));
    record.elapsed_periods = static_cast<std::uint32_t>(i % 7 == 0 ? random() : 1);
    expectComesBack(record);
  }
}

TEST_F(InputLog, PositionsOffEncoderCounts_AreRestoredBitForBit) {
  TickRecord record;
  record.q_m = AxisPosition(6);
  const double odd[] = {std::numeric_limits<double>::quiet_NaN(),
                        -std::numeric_limits<double>::quiet_NaN(),
                        std::bit_cast<double>(0x7FF8'0000'0000'1234ULL),
                        std::numeric_limits<double>::infinity(),
                        -0.0,
                        1e300,
                        -1e-310,
                        0.1 + 1e-17,
                        1e-5 * 1e17,
                        0.123456789012345};
  for (double value : odd) {
    record.q_m = AxisPosition(6, value);
    expectComesBack(record);
    record.q_m = AxisPosition(6, 0.0);  // and the next tick after it
    expectComesBack(record);
  }
}

// An axis without encoder, as the fourth one usually is, takes eight bytes; here it has one.
TEST_F(InputLog, SlowMotionOnEncoders_TakesOneBytePerAxis) {
  writing_.encoder_step[3] = reading_.encoder_step[3] = 1e-4;
  TickRecord record;
  record.q_m = AxisPosition(6);
  for (int k = 0; k < 100; ++k) {
    for (int i = 0; i < 6; ++i) record.q_m[i] = writing_.encoder_step[i] * (60 * k % 7000);
    EXPECT_LE(expectComesBack(record), 7U) << k;
  }
  EXPECT_EQ(expectComesBack(record), 1U) << "nothing moved";
}

TEST_F(InputLog, CorruptedBytes_AreNeverReadBeyondTheEnd) {
  auto random = seededRandom(4104);
  std::vector<std::byte> bytes(300);
  for (int trial = 0; trial < 20'000; ++trial) {
    for (auto& b : bytes) b = static_cast<std::byte>(random() % 64 == 0 ? 0xFF : random() % 32);
    InputLogState state = reading_;
    TickInput input;
    const std::size_t size = random() % bytes.size();
    const std::vector<std::byte> tight(bytes.begin(),
                                       bytes.begin() + static_cast<std::ptrdiff_t>(size));
    ASSERT_LE(readInput(state, tight.data(), size, input), size);
    ASSERT_LE(input.command_count, kMaxCommands);
  }
}

}  // namespace
}  // namespace wholehand::test
