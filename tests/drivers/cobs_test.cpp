// Compares CRC and COBS with published values.
#include "support/seed.hpp"
#include "support/tolerance.hpp"
#include "wire_tools.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::test {
namespace {

// CRC-16/IBM-3740, better known as CCITT-FALSE. The check value is from the catalogue of CRC
// algorithms, reveng.sourceforge.io.
TEST(Crc16, CrcOfTheDigits_IsThePublishedCheckValue) {
  const std::string digits = "123456789";
  EXPECT_EQ(wf_crc16(reinterpret_cast<const std::uint8_t*>(digits.data()), digits.size()), 0x29B1);
  EXPECT_EQ(wf_crc16(nullptr, 0), 0xFFFF) << "the register's first value";
}

// Examples of Cheshire and Baker's encoding from its Wikipedia article, without the closing zero.
TEST(Cobs, PublishedExamples_AreEncodedAndDecodedAsPublished) {
  const std::vector<std::pair<Bytes, Bytes>> examples = {
      {{0x00}, {0x01, 0x01}},
      {{0x00, 0x00}, {0x01, 0x01, 0x01}},
      {{0x00, 0x11, 0x00}, {0x01, 0x02, 0x11, 0x01}},
      {{0x11, 0x22, 0x00, 0x33}, {0x03, 0x11, 0x22, 0x02, 0x33}},
      {{0x11, 0x22, 0x33, 0x44}, {0x05, 0x11, 0x22, 0x33, 0x44}},
      {{0x11, 0x00, 0x00, 0x00}, {0x02, 0x11, 0x01, 0x01, 0x01}},
      {run(0x01, 0xFE), joined({{0xFF}, run(0x01, 0xFE)})},
      {run(0x00, 0xFE), joined({{0x01, 0xFF}, run(0x01, 0xFE)})},
      {run(0x01, 0xFF), joined({{0xFF}, run(0x01, 0xFE), {0x02, 0xFF}})},
      {joined({run(0x02, 0xFF), {0x00}}), joined({{0xFF}, run(0x02, 0xFF), {0x01, 0x01}})},
      {joined({run(0x03, 0xFF), {0x00, 0x01}}), joined({{0xFE}, run(0x03, 0xFF), {0x02, 0x01}})}};
  for (const auto& [plain, coded] : examples) {
    EXPECT_EQ(encoded(plain), coded);
    Bytes back;
    ASSERT_TRUE(decoded(coded, back));
    EXPECT_EQ(back, plain);
  }
}

TEST(Cobs, AnyBytes_AreDecodedUnchangedAndEncodedWithoutAZero) {
  auto random = seededRandom(1201);
  for (int k = 0; k < cases(2000); ++k) {
    Bytes plain(random() % 600);
    for (std::uint8_t& byte : plain)
      byte = random() % 3 == 0 ? 0 : static_cast<std::uint8_t>(random());
    const Bytes coded = encoded(plain);
    EXPECT_LE(coded.size(), plain.size() + plain.size() / 254 + 1);
    EXPECT_EQ(std::count(coded.begin(), coded.end(), 0), 0);
    Bytes back;
    ASSERT_TRUE(decoded(coded, back));
    ASSERT_EQ(back, plain);
  }
}

TEST(Cobs, CodeBeyondTheEndOrWithAZero_IsRefused) {
  Bytes plain;
  EXPECT_FALSE(decoded({}, plain));
  EXPECT_FALSE(decoded({0x03, 0x11}, plain));
  EXPECT_FALSE(decoded({0x02, 0x00}, plain));
  EXPECT_FALSE(decoded({0x00}, plain));
}

}  // namespace
}  // namespace wholehand::test
