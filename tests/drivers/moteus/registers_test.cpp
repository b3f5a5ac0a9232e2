#include "moteus/registers.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace wholehand::moteus {
namespace {

using RegisterBytes = std::vector<std::uint8_t>;

RegisterBytes payloadOf(const CanFrame& frame) {
  return {frame.data.begin(), frame.data.begin() + frame.size};
}

Answer answerOf(const RegisterBytes& bytes) {
  Answer answer;
  EXPECT_TRUE(readAnswer(bytes, answer));
  return answer;
}

// In IEEE 754, 1 is 0x3f800000, and NaN has all bits of the exponent set.
TEST(FrameWriter, Floats_AreWrittenLeastSignificantByteFirst) {
  CanFrame frame;
  FrameWriter out(frame);
  const std::array<float, 1> one = {1.0F};
  out.writeFloat(0x022, one);
  EXPECT_EQ(payloadOf(frame), (RegisterBytes{0x0d, 0x22, 0x00, 0x00, 0x80, 0x3f}));
}

TEST(FrameWriter, RegisterAbove127_TakesTwoBytes) {
  CanFrame frame;
  FrameWriter out(frame);
  out.read(RegisterType::kInt32, 0x102, 1);
  EXPECT_EQ(payloadOf(frame), (RegisterBytes{0x19, 0x82, 0x02}));  // 0x102 = 2 * 128 + 2
}

TEST(FrameWriter, RegistersThatDoNotFit_AreReportedAndLeftOut) {
  CanFrame frame;
  FrameWriter out(frame);
  const std::array<float, 15> many{};
  out.writeFloat(0x020, many);
  EXPECT_TRUE(out.whole());
  EXPECT_EQ(frame.size, 63);
  out.read(RegisterType::kFloat, 0, 4);
  EXPECT_FALSE(out.whole());
  EXPECT_LE(frame.size, 64);
}

TEST(FrameWriter, DiagnosticText_IsWrittenWithItsLengthOnChannelOne) {
  CanFrame frame;
  FrameWriter out(frame);
  out.diagnosticWrite("tel stop\n");
  EXPECT_EQ(payloadOf(frame),
            (RegisterBytes{0x40, 0x01, 0x09, 't', 'e', 'l', ' ', 's', 't', 'o', 'p', '\n'}));
}

TEST(ReadAnswer, LowestInteger_IsNaN) {
  EXPECT_TRUE(std::isnan(*answerOf({0x25, 0x01, 0x00, 0x80}).of(kPosition)));
  EXPECT_EQ(*answerOf({0x21, 0x0c, 0x80}).of(kHomeState), -128.0) << "a plain number";
}

TEST(ReadAnswer, RefusedRegister_IsCountedAndTheRestIsRead) {
  const Answer answer = answerOf({0x31, 0x0f, 0x02, 0x21, 0x0c, 0x02, 0x50, 0x50});
  EXPECT_EQ(answer.errors, 1);
  EXPECT_EQ(answer.of(kHomeState), 2.0);
}

TEST(ReadAnswer, MalformedAnswer_IsRefused) {
  const std::vector<RegisterBytes> bad = {
      {0x24},                                            // no count
      {0x24, 0x04},                                      // no register
      {0x24, 0x04, 0x00, 0x0a},                          // half a value
      {0x99, 0x00},                                      // no such subframe
      {0x01, 0x00, 0x0a},                                // a command
      {0x20, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01, 0x00},  // a count without an end
      {0x31, 0x0f},                                      // an error without its number
  };
  for (const RegisterBytes& bytes : bad) {
    Answer answer;
    EXPECT_FALSE(readAnswer(bytes, answer)) << static_cast<int>(bytes[0]) << ", " << bytes.size();
  }
}

TEST(DiagnosticAnswer, DiagnosticText_IsReadAndOtherFramesAreNot) {
  const RegisterBytes text = {0x41, 0x01, 0x03, '0', '.', '1', 0x50};
  EXPECT_EQ(diagnosticAnswer(text), "0.1");
  const RegisterBytes nothing = {0x41, 0x01, 0x00};
  EXPECT_EQ(diagnosticAnswer(nothing), "");
  for (const RegisterBytes& bytes :
       {RegisterBytes{}, RegisterBytes{0x41}, RegisterBytes{0x41, 0x02, 0x00},
        RegisterBytes{0x41, 0x01, 0x09, 'a'}, RegisterBytes{0x24}}) {
    EXPECT_FALSE(diagnosticAnswer(bytes));
  }
}

}  // namespace
}  // namespace wholehand::moteus
