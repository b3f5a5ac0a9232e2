// The text protocols of the CAN adapters, and how they handle invalid lines.
#include "moteus/can_lines.hpp"

#include "moteus/registers.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <span>
#include <string>
#include <vector>

namespace wholehand::moteus {
namespace {

CanFrame frameOf(std::uint32_t id, const std::vector<int>& bytes) {
  CanFrame frame;
  frame.id = id;
  for (const int byte : bytes) frame.data[frame.size++] = static_cast<std::uint8_t>(byte);
  return frame;
}

std::string fdcanusb(const CanFrame& frame) {
  LineBuffer line;
  return {line.data(), writeFdcanusb(frame, line)};
}

std::string slcan(const CanFrame& frame) {
  LineBuffer line;
  return {line.data(), writeSlcan(frame, line)};
}

// Example from docs/protocol/can.md of mjbots/moteus, "Example".
TEST(Fdcanusb, DocumentedFrame_IsWrittenByteForByte) {
  CanFrame frame;
  frame.id = commandId(1);
  FrameWriter out(frame);
  const std::array<std::int8_t, 1> mode = {10};
  const std::array<std::int16_t, 3> command = {0x0060, 0x0120, -176};
  out.writeInt8(kMode, mode);
  out.writeInt16(kCommandPosition, command);
  out.read(RegisterType::kInt16, kMode, 4);
  out.read(RegisterType::kInt8, kVoltage, 3);
  ASSERT_TRUE(out.whole());
  EXPECT_EQ(fdcanusb(frame), "can send 8001 01000a07206000200150ff140400130d\n");
}

TEST(Fdcanusb, DocumentedAnswer_HasTheDocumentedValues) {
  CanFrame frame;
  ASSERT_EQ(readFdcanusb("rcv 100 2404000a005000000170ff230d181400", frame), LineMeaning::kFrame);
  EXPECT_EQ(frame.id, answerId(1));
  Answer answer;
  ASSERT_TRUE(readAnswer(std::span(frame.data).first(frame.size), answer));
  ASSERT_EQ(answer.count, 7U);
  EXPECT_EQ(answer.of(kMode), 10.0);
  EXPECT_NEAR(360.0 * *answer.of(kPosition), 2.88, 1e-9);   // degrees
  EXPECT_NEAR(360.0 * *answer.of(kVelocity), 23.04, 1e-9);  // degrees per second
  EXPECT_NEAR(*answer.of(kTorque), -1.44, 1e-9);
  EXPECT_EQ(answer.of(kVoltage), 12.0);
  EXPECT_EQ(answer.of(kTemperature), 20.0);
  EXPECT_EQ(answer.of(kFault), 0.0);
  EXPECT_FALSE(answer.of(kHomeState));
}

TEST(Fdcanusb, FrameBetweenSizes_IsPaddedWithNop) {
  EXPECT_EQ(fdcanusb(frameOf(0x0001, {1, 2, 3, 4, 5, 6, 7, 8, 9})),
            "can send 0001 010203040506070809505050\n");
  EXPECT_EQ(fdcanusb(frameOf(0x12345678, {})), "can send 12345678 \n");
}

TEST(Fdcanusb, Lines_AreClassified) {
  CanFrame frame;
  EXPECT_EQ(readFdcanusb("OK", frame), LineMeaning::kAccepted);
  EXPECT_EQ(readFdcanusb("ERR unknown command", frame), LineMeaning::kRefused);
  EXPECT_EQ(readFdcanusb("rcv 100 2401 E B F t123", frame), LineMeaning::kFrame);
  EXPECT_EQ(frame.size, 2);
  for (const char* line : {"", "rcv", "rcv 100 240", "rcv 10g 24", "rcv 100 2g", "rcv 123456789 00",
                           "rcv 3fffffff 00", "can send 8001 00", "rcvv 100 24"}) {
    EXPECT_EQ(readFdcanusb(line, frame), LineMeaning::kOther) << line;
  }
  const std::string too_much = "rcv 100 " + std::string(130, '0');
  EXPECT_EQ(readFdcanusb(too_much, frame), LineMeaning::kOther);
}

// README of normaldotcom/canable2-fw: bIIILDD..., BIIIIIIIILDD..., with L as the length code.
TEST(Slcan, Frames_AreWrittenAsTheCommandsOfCanable2) {
  EXPECT_EQ(slcan(frameOf(0x101, {0xab, 0xcd})), "b1012abcd\r");
  EXPECT_EQ(slcan(frameOf(0x8001, {1, 2, 3, 4, 5, 6, 7, 8, 9})),
            "B000080019010203040506070809505050\r");
  CanFrame frame;
  ASSERT_EQ(readSlcan("b1012abcd", frame), LineMeaning::kFrame);
  EXPECT_EQ(frame.id, 0x101U);
  EXPECT_EQ(frame.size, 2);
  EXPECT_EQ(frame.data[1], 0xcd);
  EXPECT_EQ(readSlcan("\a", frame), LineMeaning::kRefused);
  EXPECT_EQ(readSlcan("z", frame), LineMeaning::kAccepted);
  for (const char* line : {"b", "b101", "b1013abcd", "b8ff1ab", "t1019010203040506070809",
                           "B400000000", "x1012abcd"}) {
    EXPECT_EQ(readSlcan(line, frame), LineMeaning::kOther) << line;
  }
}

TEST(LineSplitter, LongLine_IsDroppedAndCounted) {
  LineSplitter splitter;
  std::vector<std::string> lines;
  const std::string text = "OK\r\n" + std::string(500, 'a') + "\nrcv 100 24\nb1\a";
  for (const char byte : text) {
    if (splitter.take(byte)) lines.emplace_back(splitter.line());
  }
  EXPECT_EQ(lines, (std::vector<std::string>{"OK", "rcv 100 24", "\a"}));
  EXPECT_EQ(splitter.dropped(), 1U);
}

// For any input, no decoder reads or writes out of bounds (checked by the sanitizers), and every
// accepted frame is valid.
TEST(Decoders, RandomAndChangedInput_StaysWithinBounds) {
  auto random = test::seededRandom(1);
  const std::vector<std::string> seeds = {
      "rcv 100 2404000a005000000170ff230d181400 E B F",
      "OK",
      "ERR 3",
      "B000080019010203040506070809505050",
      "b1012abcd",
      "t1012abcd",
      "rcv 100 2c0400000020410000803f0000000000000000200c02181400",
      "rcv 100 41010461626364"};
  LineSplitter splitter;
  std::size_t frames = 0, answers = 0, texts = 0;
  const auto cases = static_cast<std::size_t>(test::cases(334'000));  // 10^7 in full
  for (std::size_t i = 0; i < cases; ++i) {
    std::string line = seeds[random() % seeds.size()];
    for (std::uint64_t changes = random() % 4; changes > 0; --changes) {
      const auto place = random() % (line.size() + 1);
      const char byte =
          static_cast<char>(random() % 4 == 0 ? random() : "0123456789abcdef"[random() % 16]);
      if (random() % 3 == 0)
        line.insert(place, 1, byte);
      else if (place < line.size() && random() % 3 == 0)
        line.erase(place, random() % 8);
      else if (place < line.size())
        line[place] = byte;
    }
    CanFrame frame;
    const bool is_frame = readFdcanusb(line, frame) == LineMeaning::kFrame ||
                          readSlcan(line, frame) == LineMeaning::kFrame;
    frames += is_frame ? 1 : 0;
    ASSERT_LE(frame.size, CanFrame::kMostBytes);
    if (!is_frame) {  // random bytes instead
      frame.size = static_cast<std::uint8_t>(random() % 65);
      for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    }
    const auto data = std::span(frame.data).first(frame.size);
    Answer answer;
    answers += readAnswer(data, answer) ? 1 : 0;
    ASSERT_LE(answer.count, Answer::kMost);
    texts += diagnosticAnswer(data) ? 1 : 0;
    for (const char byte : line) (void)splitter.take(byte);
    ASSERT_LE(splitter.line().size(), kLongestLine);
  }
  EXPECT_GT(frames, cases / 10);  // the inputs reach beyond the first check
  EXPECT_GT(answers, cases / 20);
  EXPECT_GT(texts, cases / 100);
}

}  // namespace
}  // namespace wholehand::moteus
