#pragma once

#include "server/udp_fake_backend.hpp"
#include "server/udp_host.hpp"
#include "server/udp_test_game.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

/// The conversation with games, on a clock and a network that the tests make up.
namespace wholehand::udp {

using test::FakeBackend;
using test::TestGame;
namespace words = test::words;

inline constexpr std::int64_t kMillisecond_ns = 1'000'000;
inline constexpr UdpEndpoint kGame{0x7F000001, 5001}, kOther{0x7F000001, 5002},
    kElsewhere{0x0A000005, 5003};

class UdpHost : public ::testing::Test {
 protected:
  explicit UdpHost(const Admission& admission = {})
      : host(
            admission, controls, counters,
            [this](const UdpEndpoint& to, std::span<const std::uint8_t> d) { return leave(to, d); },
            7) {
    host.setScene(backend.scene(), now_ns);
  }

  TestGame makeGame(const UdpEndpoint& at) {
    return TestGame([this, at](const TestGame::Bytes& d) {
      if (!lost()) arriving.push_back({at, d});
    });
  }
  UdpSent leave(const UdpEndpoint& to, std::span<const std::uint8_t> d) {
    if (full) return UdpSent::kFull;
    if (!lost()) leaving.push_back({to, {d.begin(), d.end()}});
    return UdpSent::kSent;
  }
  bool lost() { return static_cast<double>(random() % 1000) < 1000.0 * loss; }

  /// Everything on the way arrives, orders are carried out, as the bridge does it.
  void settle() {
    do {
      for (const auto& [from, d] : std::exchange(arriving, {})) host.receive(from, d, now_ns);
      carryOut();
      for (const auto& [to, d] : std::exchange(leaving, {})) {
        if (to == kGame) game.hear(d);
        if (to == kOther) other.hear(d);
        if (to == kElsewhere) elsewhere.hear(d);
      }
    } while (!arriving.empty() || !leaving.empty());
  }
  void carryOut() {
    for (const PendingOrder& pending : host.takeOrders()) {
      backend.order(pending.order,
                    [&](const OrderReply& reply) { host.answer(pending, reply, now_ns); });
    }
  }
  void pass(int ms) {
    for (int i = 0; i < ms; ++i) {
      now_ns += kMillisecond_ns;
      host.advance(now_ns);
      settle();
    }
  }
  std::uint64_t ignored(UdpIgnored reason) const { return counters.ignoredFor(reason); }
  /// Says hello and is welcomed.
  void connect(TestGame& who, std::uint16_t rate_hz = 1000, std::uint64_t nonce = 1) {
    who.hello(rate_hz, "", nonce);
    settle();
    ASSERT_NE(who.session, 0U);
  }
  void takeControls(TestGame& who, std::uint32_t id) {
    who.command(words::takeControls(id));
    settle();
    ASSERT_TRUE(who.replies().at(id).first) << who.replies().at(id).second;
  }
  void publish(std::uint64_t tick) {
    host.publish(backend.record(tick), backend.status(), now_ns);
    settle();
  }

  FakeBackend backend;
  ControlsArbiter controls;
  UdpCounters counters;
  std::int64_t now_ns = 1'000'000'000'000;
  double loss = 0.0;
  bool full = false;
  std::mt19937_64 random = test::seededRandom(411);
  struct OnTheWay {
    UdpEndpoint where;
    TestGame::Bytes bytes;
  };
  std::vector<OnTheWay> arriving, leaving;
  Host host;
  TestGame game = makeGame(kGame), other = makeGame(kOther), elsewhere = makeGame(kElsewhere);
};

}  // namespace wholehand::udp
