#include "server/udp_datagram.hpp"

#include "core/crc32.hpp"
#include "server/udp_peer.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace wholehand::udp {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes randomBytes(std::mt19937_64& random, std::size_t n) {
  Bytes bytes(n);
  for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
  return bytes;
}

Bytes written(const Header& header, const Bytes& payload) {
  Datagram datagram;
  const std::size_t size = write(datagram, header, payload);
  return {datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(size)};
}

Header someHeader() {
  Header header;
  header.kind = Kind::kState;
  header.session = 0x01020304;
  header.sequence = 5;
  header.monotonic_ns = -2;
  header.fragment_count = 1;
  return header;
}

/// The bytes with one of them changed, and the checksum made right again.
Bytes forged(Bytes datagram, std::size_t at, std::uint8_t value) {
  datagram[at] = value;
  const auto all = std::as_bytes(std::span(datagram)), payload = all.subspan(kHeaderSize);
  const std::uint32_t crc = crc32(crc32(0, all.data(), 32), payload.data(), payload.size());
  for (int i = 0; i < 4; ++i) datagram[32 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  return datagram;
}

TEST(UdpDatagram, ChecksumOfTheCheckString_IsTheCataloguedOne) {
  // CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms: check = 0xcbf43926.
  const std::string text = "123456789";
  const auto* bytes = reinterpret_cast<const std::byte*>(text.data());
  EXPECT_EQ(crc32(0, bytes, 9), 0xCBF43926U);
  EXPECT_EQ(crc32(crc32(0, bytes, 4), bytes + 4, 5), 0xCBF43926U);
}

TEST(UdpDatagram, Written_IsByteByByteWhatTheDocumentSays) {
  // docs/udp.md, "An example"; made with Python's struct and zlib.
  const Bytes expected = {0x57, 0x48, 0x55, 0x44, 0x01, 0x00, 0x11, 0x00, 0x04, 0x03,
                          0x02, 0x01, 0x05, 0x00, 0x00, 0x00, 0xfe, 0xff, 0xff, 0xff,
                          0xff, 0xff, 0xff, 0xff, 0x00, 0x00, 0x01, 0x00, 0x03, 0x00,
                          0x00, 0x00, 0x30, 0x1d, 0x27, 0xed, 0x61, 0x62, 0x63};
  EXPECT_EQ(written(someHeader(), {'a', 'b', 'c'}), expected);
  const Received back = read(expected);
  EXPECT_EQ(back.flaw, Flaw::kNone);
  EXPECT_EQ(back.header.kind, Kind::kState);
  EXPECT_EQ(back.header.session, 0x01020304U);
  EXPECT_EQ(back.header.sequence, 5U);
  EXPECT_EQ(back.header.monotonic_ns, -2);
  EXPECT_EQ(back.payload.size(), 3U);
}

TEST(UdpDatagram, AnyBitFlipped_IsRefused) {
  // A CRC finds every single wrong bit.
  Bytes datagram = written(someHeader(), Bytes(50, 0x5A));
  for (std::size_t bit = 0; bit < 8 * datagram.size(); ++bit) {
    datagram[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    EXPECT_NE(read(datagram).flaw, Flaw::kNone) << "bit " << bit;
    datagram[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
  }
  EXPECT_EQ(read(datagram).flaw, Flaw::kNone);
}

TEST(UdpDatagram, EveryFlaw_IsTold) {
  const Bytes good = written(someHeader(), {1, 2, 3});
  EXPECT_EQ(read({}).flaw, Flaw::kTooShort);
  EXPECT_EQ(read(Bytes(kHeaderSize - 1)).flaw, Flaw::kTooShort);
  EXPECT_EQ(read(Bytes(kLargestDatagram + 1)).flaw, Flaw::kTooLong);
  EXPECT_EQ(read(forged(good, 0, 'X')).flaw, Flaw::kWrongMagic);
  EXPECT_EQ(read(forged(good, 4, 2)).flaw, Flaw::kWrongVersion);
  EXPECT_EQ(read(forged(good, 28, 4)).flaw, Flaw::kWrongLength);
  EXPECT_EQ(read(Bytes(good.begin(), good.end() - 1)).flaw, Flaw::kWrongLength);
  Bytes damaged = good;
  damaged.back() ^= 1U;
  EXPECT_EQ(read(damaged).flaw, Flaw::kWrongChecksum);
  EXPECT_EQ(read(forged(good, 6, 5)).flaw, Flaw::kBadHeader);   // no such kind
  EXPECT_EQ(read(forged(good, 7, 1)).flaw, Flaw::kBadHeader);   // a flag
  EXPECT_EQ(read(forged(good, 24, 1)).flaw, Flaw::kBadHeader);  // fragment 1 of 1
  EXPECT_EQ(read(forged(good, 26, 0)).flaw, Flaw::kBadHeader);  // of none
  EXPECT_EQ(read(forged(good, 27, 5)).flaw, Flaw::kBadHeader);  // of 1281
  EXPECT_EQ(read(forged(good, 30, 1)).flaw, Flaw::kBadHeader);  // reserved
}

TEST(UdpDatagram, RandomBytes_AreNeverTakenForOne) {
  auto random = test::seededRandom(401);
  for (int i = 0; i < 20'000; ++i) {
    const Bytes bytes = randomBytes(random, random() % 1300);
    EXPECT_NE(read(bytes).flaw, Flaw::kNone);
    Hello hello;
    (void)readHello(bytes, hello);  // must only not look outside
  }
}

TEST(UdpDatagram, Hello_ComesBack) {
  const std::string token = "open sesame";
  Hello hello;
  hello.rate_hz = 1000;
  hello.schema_version = 7;
  hello.nonce = 0x1122334455667788;
  hello.token = {reinterpret_cast<const std::uint8_t*>(token.data()), token.size()};
  const Bytes payload = writeHello(hello);
  Hello back;
  ASSERT_TRUE(readHello(payload, back));
  EXPECT_EQ(back.rate_hz, 1000);
  EXPECT_EQ(back.schema_version, 7);
  EXPECT_EQ(back.nonce, hello.nonce);
  EXPECT_TRUE(std::equal(token.begin(), token.end(), back.token.begin(), back.token.end()));
  EXPECT_FALSE(readHello(std::span(payload).first(11), back));
  hello.rate_hz = 1001;
  EXPECT_FALSE(readHello(writeHello(hello), back));
}

TEST(UdpFragments, InAnyOrderWithRepetitions_MakeTheMessage) {
  auto random = test::seededRandom(402);
  Reassembler reassembler(100'000);
  for (std::uint32_t round = 0; round < 200; ++round) {
    const Bytes message = randomBytes(random, random() % 20'000);
    Header header = someHeader();
    header.sequence = round;
    std::vector<Bytes> datagrams;
    const auto count = forEachFragment(header, message, [&](std::span<const std::uint8_t> d) {
      EXPECT_LE(d.size(), kLargestDatagram);
      datagrams.emplace_back(d.begin(), d.end());
    });
    EXPECT_EQ(count, datagrams.size());
    std::shuffle(datagrams.begin(), datagrams.end(), random);
    for (std::size_t i = 0; i < datagrams.size(); ++i) {
      const Received r = read(datagrams[i]);
      ASSERT_EQ(r.flaw, Flaw::kNone);
      const bool last = i + 1 == datagrams.size();
      EXPECT_EQ(reassembler.add(r.header, r.payload),
                last ? Reassembler::Result::kComplete : Reassembler::Result::kIncomplete);
      if (!last) {
        EXPECT_EQ(reassembler.add(r.header, r.payload), Reassembler::Result::kRepeated);
      }
    }
    EXPECT_TRUE(std::equal(message.begin(), message.end(), reassembler.message().begin(),
                           reassembler.message().end()));
  }
}

TEST(UdpFragments, ThatContradictOrGrowTooLarge_AreRefused) {
  Reassembler reassembler(3 * kLargestPayload);
  const Bytes full(kLargestPayload, 1);
  Header header = someHeader();
  header.fragment_count = 3;
  EXPECT_EQ(reassembler.add(header, full), Reassembler::Result::kIncomplete);
  header.fragment_index = 1;
  EXPECT_EQ(reassembler.add(header, Bytes(10, 1)), Reassembler::Result::kRefused);  // not full
  header.fragment_count = 2;
  EXPECT_EQ(reassembler.add(header, full), Reassembler::Result::kRefused);  // of 2, not of 3
  header.fragment_count = 4;
  header.fragment_index = 3;
  EXPECT_EQ(reassembler.add(header, Bytes(1, 1)), Reassembler::Result::kRefused);  // too large
}

TEST(UdpFragments, OfALaterMessage_DropTheEarlierOne) {
  Reassembler reassembler(10'000);
  Header first = someHeader();
  first.fragment_count = 2;
  EXPECT_EQ(reassembler.add(first, Bytes(kLargestPayload, 1)), Reassembler::Result::kIncomplete);
  Header second = someHeader();
  second.sequence = first.sequence + 1;
  second.fragment_count = 1;
  EXPECT_EQ(reassembler.add(second, Bytes(5, 2)), Reassembler::Result::kComplete);
  EXPECT_EQ(reassembler.message().size(), 5U);
}

TEST(UdpReplayWindow, RandomSequences_PassOnceAndNeverWhenOld) {
  // Held against a set of all that ever came.
  auto random = test::seededRandom(403);
  for (const std::uint32_t start : {0U, 1000U, 0xFFFFFF00U}) {
    ReplayWindow window;
    std::set<std::uint32_t> came;
    std::uint32_t newest = start;
    for (int i = 0; i < 2000; ++i) {
      const std::uint32_t sequence = newest + static_cast<std::uint32_t>(random() % 80) - 70;
      const auto behind = static_cast<std::int32_t>(newest - sequence);
      const bool expected =
          came.empty() || behind < 0 || (behind < 64 && came.count(sequence) == 0);
      ASSERT_EQ(window.isNew(sequence), expected) << "behind by " << behind;
      if (!expected) continue;
      window.accept(sequence);
      if (came.empty() || behind < 0) newest = sequence;
      came.insert(sequence);
    }
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
    // Evenly: no gap differs by more than a tick from another.
    EXPECT_EQ(widest, (1000 + rate_hz - 1) / rate_hz);
    EXPECT_EQ(narrowest, 1000 / rate_hz);
  }
}

TEST(UdpDecimator, OtherLoops_KeepTheRate) {
  const auto sentInASecond = [](std::uint32_t rate_hz, std::uint32_t tick_rate_hz) {
    Decimator decimator(rate_hz, tick_rate_hz);
    int n = 0;
    for (std::uint64_t tick = 0; tick < tick_rate_hz; ++tick) n += decimator.due(tick) ? 1 : 0;
    return n;
  };
  EXPECT_EQ(sentInASecond(1000, 4000), 1000);
  EXPECT_EQ(sentInASecond(60, 2000), 60);
  EXPECT_EQ(sentInASecond(1000, 500), 500);  // a slow loop: every tick
  EXPECT_EQ(sentInASecond(0, 1000), 0);
}

TEST(UdpDecimator, SameTickAndNewSession_AreOnceAndAtOnce) {
  Decimator decimator(10, 1000);
  EXPECT_TRUE(decimator.due(5000));
  EXPECT_FALSE(decimator.due(5000));
  EXPECT_FALSE(decimator.due(5001));
  EXPECT_TRUE(decimator.due(0));     // ticks began anew
  EXPECT_TRUE(decimator.due(2500));  // skipped ticks: one state, not 25
  EXPECT_FALSE(decimator.due(2501));
}

TEST(UdpOutbox, NeverAcknowledged_IsRepeatedAfterEverLongerPauses) {
  ReliableOutbox outbox;
  ASSERT_TRUE(outbox.add(std::make_shared<const wire::Bytes>(Bytes{1})));
  std::vector<int> sent_ms;
  for (int t_ms = 0; t_ms <= 2500; ++t_ms) {
    outbox.sendDue(t_ms * 1'000'000LL, [&](std::uint32_t sequence, const wire::Bytes&, bool again) {
      EXPECT_EQ(sequence, 1U);
      EXPECT_EQ(again, !sent_ms.empty());
      sent_ms.push_back(t_ms);
    });
  }
  // At once, after 50 ms, 100, 200, 400, then every 500.
  EXPECT_EQ(sent_ms, (std::vector<int>{0, 50, 150, 350, 750, 1250, 1750, 2250}));
}

TEST(UdpOutbox, Acknowledged_IsSentNoMoreAndMakesRoom) {
  ReliableOutbox outbox;
  const auto message = std::make_shared<const wire::Bytes>(Bytes{1});
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(outbox.add(message));
  std::vector<std::uint32_t> sent;
  const auto note = [&](std::uint32_t sequence, const wire::Bytes&, bool) {
    sent.push_back(sequence);
  };
  outbox.sendDue(0, note);
  EXPECT_EQ(sent.size(), ReliableOutbox::kMostUnderway);
  outbox.acknowledge(33);  // never sent: nobody can have got it
  EXPECT_EQ(outbox.size(), 40U);
  outbox.acknowledge(2);
  outbox.acknowledge(2);
  EXPECT_EQ(outbox.size(), 39U);
  sent.clear();
  outbox.sendDue(1, note);
  EXPECT_EQ(sent, (std::vector<std::uint32_t>{33}));
  std::size_t waiting = outbox.size();
  while (outbox.add(message)) ++waiting;
  EXPECT_EQ(waiting, ReliableOutbox::kMostWaiting);
}

}  // namespace
}  // namespace wholehand::udp
