#include "station/server/udp_host.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>
#include <zlib.h>

namespace wholehand::udp {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kChecksumAt = 44;

Header someHeader() {
  Header h;
  h.kind = Kind::kState;
  h.holds_controls = true;
  h.key = 0x0102030405060708;
  h.sequence = 5;
  h.rate_or_stop = 7;
  h.sent_ns = -2;
  h.echo_ns = 3;
  h.echo_age_us = 4;
  return h;
}

Bytes written(const Header& header, const Bytes& payload) {
  Datagram d;
  const std::size_t size = write(d, header, payload);
  return {d.begin(), d.begin() + static_cast<std::ptrdiff_t>(size)};
}

/// Sets the checksum with zlib, an implementation independent of the one under test.
void makeChecksumRight(Bytes& d) {
  uLong crc = ::crc32(0, d.data(), kChecksumAt);
  crc = ::crc32(crc, d.data() + kHeaderSize, static_cast<uInt>(d.size() - kHeaderSize));
  const auto value = static_cast<std::uint32_t>(crc);
  std::memcpy(d.data() + kChecksumAt, &value, sizeof value);
}

Flaw flawWith(Bytes d, std::size_t at, std::uint8_t value) {
  d[at] = value;
  makeChecksumRight(d);
  return read(d).flaw;
}

TEST(UdpDatagram, WrittenDatagram_MatchesTheDocumentByteByByte) {
  // The example of docs/udp.md, "An example"; made by Python's struct and zlib.
  const std::string expected =
      "57485544"
      "0200"
      "10"
      "01"
      "0807060504030201"
      "05000000"
      "07000000"
      "feffffffffffffff"
      "0300000000000000"
      "04000000"
      "26fe6db6"
      "616263";
  std::string hex;
  for (const std::uint8_t b : written(someHeader(), {'a', 'b', 'c'})) {
    char two[3];
    std::snprintf(two, sizeof two, "%02x", b);
    hex += two;
  }
  EXPECT_EQ(hex, expected);
}

TEST(UdpDatagram, ReadDatagram_EqualsTheWrittenOne) {
  const Bytes d = written(someHeader(), Bytes(kLargestPayload, 9));
  EXPECT_EQ(d.size(), 1200U);
  const Received r = read(d);
  ASSERT_EQ(r.flaw, Flaw::kNone);
  EXPECT_EQ(r.header.kind, Kind::kState);
  EXPECT_TRUE(r.header.holds_controls);
  EXPECT_EQ(r.header.key, 0x0102030405060708U);
  EXPECT_EQ(r.header.sequence, 5U);
  EXPECT_EQ(r.header.rate_or_stop, 7U);
  EXPECT_EQ(r.header.sent_ns, -2);
  EXPECT_EQ(r.header.echo_ns, 3);
  EXPECT_EQ(r.header.echo_age_us, 4U);
  EXPECT_EQ(r.payload.size(), kLargestPayload);
}

TEST(UdpDatagram, EveryFlaw_IsReported) {
  const Bytes good = written(someHeader(), {1, 2, 3});
  EXPECT_EQ(read({}).flaw, Flaw::kTooShort);
  EXPECT_EQ(read(Bytes(47)).flaw, Flaw::kTooShort);
  EXPECT_EQ(read(Bytes(1201)).flaw, Flaw::kTooLong);
  EXPECT_EQ(flawWith(good, 0, 0), Flaw::kWrongMagic);
  EXPECT_EQ(flawWith(good, 4, 1), Flaw::kWrongVersion);
  EXPECT_EQ(read(Bytes(good.begin(), good.end() - 1)).flaw, Flaw::kWrongChecksum) << "cut";
  EXPECT_EQ(flawWith(good, 6, 99), Flaw::kBadHeader) << "kind";
  EXPECT_EQ(flawWith(good, 7, 2), Flaw::kBadHeader) << "flags";
  EXPECT_EQ(flawWith(good, 6, 17), Flaw::kBadHeader) << "a Present with a payload";
  Header game;
  game.kind = Kind::kCommand;
  const Bytes command = written(game, {1});
  EXPECT_EQ(read(command).flaw, Flaw::kNone);
  EXPECT_EQ(flawWith(command, 7, 1), Flaw::kBadHeader) << "a game sends no controls";
  EXPECT_EQ(flawWith(command, 21, 4), Flaw::kBadHeader) << "1024 states a second";
  EXPECT_EQ(read(written(game, {})).flaw, Flaw::kBadHeader) << "a Command of nothing";
}

TEST(UdpDatagram, AnyBitFlipped_IsRefused) {
  Bytes d = written(someHeader(), Bytes(50, 3));
  for (std::size_t bit = 0; bit < 8 * d.size(); ++bit) {
    d[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    ASSERT_NE(read(d).flaw, Flaw::kNone) << "bit " << bit;
    d[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
  }
}

TEST(UdpDatagram, RandomBytes_AreNeverAccepted) {
  auto random = test::seededRandom(410);
  for (int i = 0; i < 20'000; ++i) {
    Bytes d(random() % 1300);
    for (auto& b : d) b = static_cast<std::uint8_t>(random());
    ASSERT_NE(read(d).flaw, Flaw::kNone);
  }
}

TEST(UdpDecimator, EveryRate_IsExactAndEven) {
  for (std::uint32_t rate_hz = 1; rate_hz <= 1000; ++rate_hz) {
    Decimator decimator(rate_hz, 1000);
    ASSERT_TRUE(decimator.due(0));
    std::uint64_t sent = 0, last = 0, widest = 0, narrowest = 1000;
    for (std::uint64_t tick = 1; tick <= 10'000; ++tick) {
      if (!decimator.due(tick)) continue;
      ++sent;
      widest = std::max(widest, tick - last);
      narrowest = std::min(narrowest, tick - last);
      last = tick;
    }
    EXPECT_EQ(sent, 10U * rate_hz);
    // Evenly spaced: gaps differ by one tick at most.
    EXPECT_EQ(widest, (1000 + rate_hz - 1) / rate_hz);
    EXPECT_EQ(narrowest, 1000 / rate_hz);
  }
}

TEST(UdpDecimator, OtherLoopRates_KeepTheStateRate) {
  const auto sentInASecond = [](std::uint32_t rate_hz, std::uint32_t tick_rate_hz) {
    Decimator decimator(rate_hz, tick_rate_hz);
    int n = 0;
    for (std::uint64_t tick = 0; tick < tick_rate_hz; ++tick) n += decimator.due(tick) ? 1 : 0;
    return n;
  };
  EXPECT_EQ(sentInASecond(1000, 4000), 1000);
  EXPECT_EQ(sentInASecond(60, 2000), 60);
  EXPECT_EQ(sentInASecond(1000, 500), 500);  // a slow loop sends every tick
  EXPECT_EQ(sentInASecond(0, 1000), 0);
}

TEST(UdpDecimator, RepeatedTick_IsSentOnceAndNewSessionAtOnce) {
  Decimator decimator(10, 1000);
  EXPECT_TRUE(decimator.due(5000));
  EXPECT_FALSE(decimator.due(5000));
  EXPECT_FALSE(decimator.due(5001));
  EXPECT_TRUE(decimator.due(0));     // ticks restart at 0
  EXPECT_TRUE(decimator.due(2500));  // after skipped ticks one state is due, not 25
  EXPECT_FALSE(decimator.due(2501));
}

}  // namespace
}  // namespace wholehand::udp
