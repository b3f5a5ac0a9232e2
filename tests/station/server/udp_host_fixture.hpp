#pragma once

#include "station/server/udp_fake_backend.hpp"
#include "station/server/udp_host.hpp"
#include "station/server/udp_test_game.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <utility>

/// Tests of udp::Host on a simulated clock and network.
namespace wholehand::udp {

using test::FakeBackend;
using test::TestGame;
namespace words = test::words;

inline constexpr std::int64_t kMillisecond_ns = 1'000'000;
inline constexpr UdpEndpoint kGame{0x7F000001, 5001}, kOther{0x7F000001, 5002},
    kElsewhere{0x0A000005, 5003};
inline constexpr std::uint64_t kGameKey = 0x1122334455667788, kOtherKey = 0x99AABBCCDDEEFF00;

class UdpHost : public ::testing::Test {
 protected:
  UdpHost()
      : host(controls, counters, [this](const UdpEndpoint& to, std::span<const std::uint8_t> d) {
          return leave(to, d);
        }) {
    host.setScene(backend.scene());
    game.key = kGameKey;
    other.key = kOtherKey;
    client = controls.newClient();
    host.admit(kGameKey, client, false);
    host.admit(kOtherKey, controls.newClient(), false);
  }

  TestGame makeGame(const UdpEndpoint& at) {
    return TestGame([this, at](const TestGame::Bytes& d) { arriving.push_back({at, d}); });
  }
  UdpSent leave(const UdpEndpoint& to, std::span<const std::uint8_t> d) {
    sent_bytes += d.size();
    leaving.push_back({to, {d.begin(), d.end()}});
    return UdpSent::kSent;
  }
  void arrive(const UdpEndpoint& from, const TestGame::Bytes& d) { host.receive(from, d, now_ns); }
  /// Delivers all datagrams.
  void settle() {
    do {
      for (const auto& [from, d] : std::exchange(arriving, {})) arrive(from, d);
      for (const auto& [to, d] : std::exchange(leaving, {})) {
        if (to == kGame) game.receive(d);
        if (to == kOther) other.receive(d);
      }
    } while (!arriving.empty() || !leaving.empty());
    takeCommands();
  }
  /// Takes the commands of games and carries them out.
  void takeCommands() {
    for (auto& s : host.takeCommands()) {
      if (s.order.is<orders::EmergencyStop>()) host.finishStop(s, true);
      said.push_back(std::move(s));
    }
  }
  void pass(int ms) {
    for (int i = 0; i < ms; ++i) {
      now_ns += kMillisecond_ns;
      host.advance(now_ns);
      settle();
    }
  }
  /// Connects a game: it sends a sign of life, is answered, and echoes the answer.
  void connect(TestGame& who, std::uint32_t rate_hz = 1000) {
    who.rate_hz = rate_hz;
    for (int i = 0; i < 2; ++i) {
      who.send();
      settle();
    }
  }
  void publish(std::uint64_t tick) {
    host.publish(backend.record(tick), backend.status(), now_ns);
    settle();
  }
  std::uint64_t ignored(UdpIgnored reason) const { return counters.ignoredFor(reason); }
  /// Number of orders of these kinds.
  template <class... Kinds>
  int sentOf() const {
    return static_cast<int>(std::count_if(said.begin(), said.end(), [](const ReceivedCommand& s) {
      return (s.order.is<Kinds>() || ...);
    }));
  }
  int gentleStops() const { return sentOf<orders::Stop, orders::Rest>(); }

  FakeBackend backend;
  ControlHolder controls;
  UdpCounters counters;
  std::int64_t now_ns = 1'000'000'000'000;
  std::mt19937_64 random = test::seededRandom(411);
  struct OnTheWay {
    UdpEndpoint where;
    TestGame::Bytes bytes;
  };
  std::vector<OnTheWay> arriving, leaving;
  std::size_t sent_bytes = 0;  ///< bytes sent by the program
  std::vector<ReceivedCommand> said;
  Host host;
  ControlHolder::Client client = 0;
  TestGame game = makeGame(kGame), other = makeGame(kOther);
};

}  // namespace wholehand::udp
