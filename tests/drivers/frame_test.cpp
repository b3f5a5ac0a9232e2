// The frame as sent on a line, compared with the table in frame.h and tested against damage.
#include "drivers/frame/firmware/frame.h"

#include "support/seed.hpp"
#include "support/tolerance.hpp"
#include "wire_tools.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace wholehand::test {
namespace {

template <class Random>
wf_frame randomFrame(Random& random) {
  wf_frame frame{};
  frame.version = WF_VERSION;
  frame.kind = static_cast<std::uint8_t>(1 + random() % 8);
  frame.axes = static_cast<std::uint8_t>(1 + random() % WF_MAX_AXES);
  frame.index = static_cast<std::uint8_t>(random());
  frame.session = static_cast<std::uint32_t>(random());
  frame.sequence = static_cast<std::uint32_t>(random());
  const auto value = [&random] {
    return static_cast<float>(static_cast<std::int64_t>(random() % 2'000'001) - 1'000'000) * 1e-3F;
  };
  if (frame.kind == WF_WELCOME) {
    std::strcpy(frame.name, "a board");
    std::strcpy(frame.serial, "B-0042");
    std::strcpy(frame.firmware, "1.2.3");
  }
  if (frame.kind == WF_AXIS) {
    frame.axis = {"finger_flexion", 1, 2, value(), value(), value(), value(), value(), value()};
  }
  if (frame.kind == WF_CONTROL) frame.argument = value();
  if (frame.kind == WF_ANSWER) frame.result = static_cast<std::int32_t>(random());
  if (frame.kind == WF_SAMPLE) {
    frame.time_us = static_cast<std::uint32_t>(random());
    frame.status = static_cast<std::uint32_t>(random());
    frame.valid = static_cast<std::uint32_t>(random());
    frame.heard = static_cast<std::uint32_t>(random());
    frame.vendor_code = static_cast<std::int32_t>(random());
  }
  for (int i = 0; i < frame.axes; ++i) {
    if (frame.kind == WF_SAMPLE) frame.position[i] = value();
    if (frame.kind == WF_SAMPLE || frame.kind == WF_COMMAND) frame.effort[i] = value();
  }
  return frame;
}

Bytes wireOf(const wf_frame& frame) {
  Bytes wire(WF_MAX_WIRE);
  wire.resize(wf_encode(&frame, wire.data()));
  return wire;
}

// The last outcome other than WF_NONE, and the number of good frames.
struct Received {
  wf_outcome last = WF_NONE;
  int good = 0;
  wf_frame frame{};
};
Received receive(wf_receiver& receiver, const Bytes& wire) {
  Received received;
  for (const std::uint8_t byte : wire) {
    wf_frame frame{};
    const wf_outcome outcome = wf_receive(&receiver, byte, &frame);
    if (outcome == WF_NONE) continue;
    received.last = outcome;
    if (outcome != WF_GOOD) continue;
    ++received.good;
    received.frame = frame;
  }
  return received;
}

void expectSame(const wf_frame& is, const wf_frame& was) {
  EXPECT_EQ(is.kind, was.kind);
  EXPECT_EQ(is.axes, was.axes);
  EXPECT_EQ(is.index, was.index);
  EXPECT_EQ(is.session, was.session);
  EXPECT_EQ(is.sequence, was.sequence);
  EXPECT_STREQ(is.name, was.name);
  EXPECT_STREQ(is.serial, was.serial);
  EXPECT_STREQ(is.firmware, was.firmware);
  EXPECT_STREQ(is.axis.name, was.axis.name);
  EXPECT_EQ(is.axis.kind, was.axis.kind);
  EXPECT_EQ(is.axis.effort_meaning, was.axis.effort_meaning);
  EXPECT_EQ(0, std::memcmp(&is.axis.lower, &was.axis.lower, 6 * sizeof(float)));
  EXPECT_EQ(is.argument, was.argument);
  EXPECT_EQ(is.result, was.result);
  EXPECT_EQ(is.time_us, was.time_us);
  EXPECT_EQ(is.status, was.status);
  EXPECT_EQ(is.valid, was.valid);
  EXPECT_EQ(is.heard, was.heard);
  EXPECT_EQ(is.vendor_code, was.vendor_code);
  EXPECT_EQ(0, std::memcmp(is.position, was.position, sizeof(is.position)));
  EXPECT_EQ(0, std::memcmp(is.effort, was.effort, sizeof(is.effort)));
}

// The bytes must match the table in frame.h; the numbers are IEEE 754 in hexadecimal.
TEST(Frame, Command_HasTheBytesOfTheTable) {
  wf_frame frame{};
  frame.kind = WF_COMMAND;
  frame.axes = 2;
  frame.session = 0x04030201;
  frame.sequence = 0x0A0B0C0D;
  frame.effort[0] = 1.0F;   // 0x3F800000
  frame.effort[1] = -2.5F;  // 0xC0200000
  const Bytes wire = wireOf(frame);
  ASSERT_EQ(wire.front(), 0);
  ASSERT_EQ(wire.back(), 0);
  Bytes plain;
  ASSERT_TRUE(decoded(Bytes(wire.begin() + 1, wire.end() - 1), plain));
  const Bytes table = {1,    7,    2,    0,    0x01, 0x02, 0x03, 0x04, 0x0D, 0x0C,
                       0x0B, 0x0A, 0x00, 0x00, 0x80, 0x3F, 0x00, 0x00, 0x20, 0xC0};
  ASSERT_EQ(plain.size(), table.size() + 2);
  EXPECT_EQ(Bytes(plain.begin(), plain.end() - 2), table);
  EXPECT_EQ(plain[20] | plain[21] << 8, wf_crc16(table.data(), table.size()));
}

TEST(Frame, SampleOfSixAxes_FitsALineOfOneMegabaudAt1kHz) {
  wf_frame frame{};
  frame.kind = WF_SAMPLE;
  frame.axes = 6;
  const Bytes wire = wireOf(frame);
  EXPECT_EQ(wire.size(), 85U);  // 32 + 8 x 6 + CRC 2, COBS 1, zeros 2
  EXPECT_LE(wire.size() * 10 * 1000, 1'000'000U) << "10 bits a byte";
}

TEST(Frame, AnyFrame_IsDecodedUnchanged) {
  auto random = seededRandom(1202);
  wf_receiver receiver{};
  for (int k = 0; k < cases(5000); ++k) {
    const wf_frame frame = randomFrame(random);
    const Received received = receive(receiver, wireOf(frame));
    ASSERT_EQ(received.good, 1);
    expectSame(received.frame, frame);
    ASSERT_FALSE(HasFailure());
  }
}

TEST(Frame, ImpossibleKindOrAxes_IsNotEncoded) {
  wf_frame frame{};
  frame.kind = 9;
  frame.axes = 3;
  EXPECT_TRUE(wireOf(frame).empty());
  frame.kind = WF_SAMPLE;
  frame.axes = WF_MAX_AXES + 1;
  EXPECT_TRUE(wireOf(frame).empty());
  frame.axes = 0;
  EXPECT_TRUE(wireOf(frame).empty());
}

TEST(Frame, FrameAfterATruncatedOne_IsReceived) {
  auto random = seededRandom(1203);
  for (int k = 0; k < cases(2000); ++k) {
    wf_receiver receiver{};
    Bytes half = wireOf(randomFrame(random));
    half.resize(1 + random() % (half.size() - 2));  // cuts off more than the last zero
    const wf_frame next = randomFrame(random);
    (void)receive(receiver, half);
    const Received received = receive(receiver, wireOf(next));
    EXPECT_EQ(received.good, 1) << "the half is no frame, the next one is";
    expectSame(received.frame, next);
    ASSERT_FALSE(HasFailure());
  }
}

TEST(Frame, LineWithoutAZero_IsReportedWithoutAnOverrun) {
  wf_receiver receiver{};
  Bytes endless(100'000, 0x55);
  EXPECT_EQ(receive(receiver, endless).last, WF_NONE);
  EXPECT_EQ(receive(receiver, {0}).last, WF_BROKEN);
  wf_frame frame{};
  frame.kind = WF_HELLO;
  EXPECT_EQ(receive(receiver, wireOf(frame)).good, 1);
}

TEST(Frame, FrameOfAnotherVersion_IsReportedWithItsKindAndSession) {
  wf_frame frame{};
  frame.kind = WF_HELLO;
  frame.session = 77;
  Bytes plain;
  const Bytes wire = wireOf(frame);
  ASSERT_TRUE(decoded(Bytes(wire.begin() + 1, wire.end() - 1), plain));
  plain[0] = WF_VERSION + 1;
  plain.resize(plain.size() - 2);
  plain.insert(plain.end(), {1, 2, 3});  // a frame of a later version may be longer
  const std::uint16_t crc = wf_crc16(plain.data(), plain.size());
  plain.push_back(static_cast<std::uint8_t>(crc));
  plain.push_back(static_cast<std::uint8_t>(crc >> 8));
  Bytes coded = encoded(plain);
  coded.push_back(0);
  wf_receiver receiver{};
  wf_outcome reported = WF_NONE;
  wf_frame taken{};
  for (const std::uint8_t byte : coded) reported = wf_receive(&receiver, byte, &taken);
  EXPECT_EQ(reported, WF_OTHER_VERSION);
  EXPECT_EQ(taken.version, WF_VERSION + 1);
  EXPECT_EQ(taken.kind, WF_HELLO);
  EXPECT_EQ(taken.session, 77U);
}

// The generator polynomial has the factor x + 1 and a primitive one of degree 15, so it detects all
// errors of up to 3 bits in up to 32,767 bits. This tests all errors of 1 and 2 bits in a sample of
// 3 axes, and some of 3.
TEST(Frame, ErrorsOfOneToThreeBits_AreAllDetected) {
  auto random = seededRandom(1204);
  wf_frame frame{};
  frame.kind = WF_SAMPLE;
  frame.axes = 3;
  const Bytes wire = wireOf(frame);
  Bytes plain;
  ASSERT_TRUE(decoded(Bytes(wire.begin() + 1, wire.end() - 1), plain));
  const std::size_t bits = 8 * plain.size();
  const auto good = [](const Bytes& bytes) {
    const std::size_t n = bytes.size() - 2;
    return wf_crc16(bytes.data(), n) == (bytes[n] | bytes[n + 1] << 8);
  };
  const auto flip = [&plain](std::size_t bit) {
    plain[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
  };
  ASSERT_TRUE(good(plain));
  for (std::size_t a = 0; a < bits; ++a) {
    flip(a);
    ASSERT_FALSE(good(plain));
    for (std::size_t b = a + 1; b < bits; ++b) {
      flip(b);
      ASSERT_FALSE(good(plain)) << a << " " << b;
      const std::size_t c = random() % bits;
      if (c != a && c != b) {
        flip(c);
        ASSERT_FALSE(good(plain)) << a << " " << b << " " << c;
        flip(c);
      }
      flip(b);
    }
    flip(a);
  }
}

// Any input may give any frame, but within the structure: names are terminated, and there are at
// most 16 axes. 10^7 inputs with WHOLEHAND_FULL=1; a sanitizer checks the memory.
TEST(Frame, RandomAndMutatedInputs_StayWithinTheStructures) {
  const int inputs = std::getenv("WHOLEHAND_FULL") != nullptr ? 10'000'000 : 100'000;
  auto random = seededRandom(1205);
  wf_receiver receiver{};
  long good = 0, refused = 0;
  for (int k = 0; k < inputs; ++k) {
    Bytes input = wireOf(randomFrame(random));
    const auto how = random() % 8;
    if (how == 0) input.assign(random() % 300, static_cast<std::uint8_t>(random()));
    const auto changes = how == 1 ? 0 : 1 + random() % 4;
    for (std::uint64_t c = 0; c < changes && !input.empty(); ++c) {
      const std::size_t at = random() % input.size();
      if (how < 5) input[at] = static_cast<std::uint8_t>(random());
      if (how == 5) input.erase(input.begin() + static_cast<std::ptrdiff_t>(at));
      if (how == 6)
        input.insert(input.begin() + static_cast<std::ptrdiff_t>(at),
                     static_cast<std::uint8_t>(random()));
      if (how == 7) input.resize(at);
    }
    for (const std::uint8_t byte : input) {
      wf_frame frame{};
      const wf_outcome outcome = wf_receive(&receiver, byte, &frame);
      ASSERT_LE(receiver.count, static_cast<std::uint32_t>(WF_MAX_WIRE));
      if (outcome == WF_BROKEN || outcome == WF_CRC_ERROR) ++refused;
      if (outcome != WF_GOOD) continue;
      ++good;
      ASSERT_LE(frame.axes, WF_MAX_AXES);
      ASSERT_LT(::strnlen(frame.name, WF_NAME), std::size_t{WF_NAME});
      ASSERT_LT(::strnlen(frame.axis.name, WF_NAME), std::size_t{WF_NAME});
    }
  }
  EXPECT_GT(good, inputs / 20) << "those that nobody changed";
  EXPECT_GT(refused, inputs / 4) << "the others";
}

TEST(Sequence, IsNewer_HoldsAcrossTheWrapAround) {
  EXPECT_TRUE(wf_newer(1, 0));
  EXPECT_FALSE(wf_newer(1, 1));
  EXPECT_FALSE(wf_newer(1, 2));
  EXPECT_TRUE(wf_newer(0, UINT32_MAX));
  EXPECT_FALSE(wf_newer(UINT32_MAX, 0));
}

}  // namespace
}  // namespace wholehand::test
