#include "station/server/udp_bridge.hpp"

#include "loop/realtime/monotonic_clock.hpp"
#include "station/server/fake_program.hpp"
#include "station/server/server.hpp"
#include "station/server/udp_fake_backend.hpp"
#include "station/server/udp_test_game.hpp"
#include "support/figure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <thread>

// WebSocket and datagrams together, on real sockets. No test depends on the speed of the machine:
// it waits for late messages.
namespace wholehand {
namespace {

using test::FakeBackend;
using test::TestGame;
using test::WebSocket;
namespace fb = wholehand::protocol;
namespace words = test::words;
namespace replies = test::replies;

constexpr UdpEndpoint kAnyPort{0x7F000001, 0};
constexpr std::uint64_t kKeyOfTheStart = 0xFEDCBA9876543210;

/// A game's datagrams over its own socket.
struct SocketGame {
  SocketGame(const UdpEndpoint& program, std::uint64_t key, std::uint32_t rate_hz) : to(program) {
    if (!socket.open(kAnyPort)) throw std::runtime_error("no socket");
    game.key = key;
    game.rate_hz = rate_hz;
  }
  /// Sends signs of life and reads all datagrams; true if the condition holds within 20 s.
  template <class Condition>
  bool until(Condition condition) {
    std::array<std::uint8_t, 2000> buffer;
    UdpEndpoint from;
    for (const std::int64_t end = monotonicNow_ns() + 120'000'000'000; monotonicNow_ns() < end;) {
      for (long n; (n = socket.receive(from, buffer)) >= 0;) {
        game.receive({buffer.data(), static_cast<std::size_t>(n)});
      }
      if (condition()) return true;
      game.send();
      socket.wait(5);
    }
    return false;
  }
  /// The same, but sends `message` again and again, because datagrams may be lost.
  template <class Condition>
  bool sendUntil(const std::function<TestGame::Bytes()>& message, Condition condition) {
    return until([&] {
      if (condition()) return true;
      game.send(message());
      return false;
    });
  }

  UdpEndpoint to;
  UdpSocket socket;
  TestGame game{[this](const TestGame::Bytes& d) { (void)socket.send(to, d); }};
};

/// A complete game: a WebSocket, and datagrams with the key of its Welcome.
struct WholeGame {
  WholeGame(Server& server, const UdpBridge& bridge, std::uint32_t rate_hz)
      : socket(server.port()) {
    const auto frame = replies::next(socket, fb::Payload::Welcome);
    if (!frame) throw std::runtime_error("no welcome");
    const auto* welcome = replies::message(*frame).payload_as_Welcome();
    EXPECT_EQ(welcome->udp_port(), bridge.local().port);
    fast = std::make_unique<SocketGame>(bridge.local(), welcome->udp_key(), rate_hz);
  }
  replies::Answer answerTo(const wire::Bytes& message) {
    socket.send(message);
    return replies::answer(socket);
  }

  WebSocket socket;
  std::unique_ptr<SocketGame> fast;
};

class UdpBridgeOnLoopback : public ::testing::Test {
 protected:
  explicit UdpBridgeOnLoopback(std::uint64_t key = 0) : bridge(backend, controls) {
    (void)test::orThrow(bridge.start({kAnyPort, key}));
    ServerOptions options;
    options.port = 0;
    options.udp = &bridge;
    server = test::orThrow(Server::open(backend, options, controls));
  }
  FakeBackend backend;
  ControlHolder controls;
  UdpBridge bridge;
  std::unique_ptr<Server> server;
};

TEST_F(UdpBridgeOnLoopback, EveryTick_ReachesTheGameInOrder) {
  const WholeGame g(*server, bridge, 1000);
  TestGame& game = g.fast->game;
  ASSERT_TRUE(g.fast->until([&] { return !game.state_ticks.empty(); }));
  for (std::uint64_t tick = 1; tick <= 3000; ++tick) {
    bridge.publish(backend.record(tick));
    // The game's buffer holds some hundred datagrams; the game reads before it is full.
    if (tick % 50 == 0) {
      const auto& reported = game.state_ticks;
      ASSERT_TRUE(g.fast->until(
          [&] { return std::find(reported.begin(), reported.end(), tick) != reported.end(); }));
    }
  }
  std::erase(game.state_ticks, 0U);  // states from before the first record
  ASSERT_EQ(game.state_ticks.size(), 3000U);
  for (std::uint64_t i = 0; i < 3000; ++i) ASSERT_EQ(game.state_ticks[i], i + 1);
  EXPECT_EQ(bridge.counters().dropped_full, 0U);
}

TEST_F(UdpBridgeOnLoopback, ControlsByWebSocketAndAimsByDatagram_MoveTheHand) {
  WholeGame g(*server, bridge, 60);
  ASSERT_TRUE(g.answerTo(words::takeControls(1)).accepted);
  ASSERT_TRUE(g.answerTo(words::arm(2)).accepted);
  const std::vector<float> aim(9, 0.03F);
  std::uint32_t id = 2;
  ASSERT_TRUE(g.fast->sendUntil([&] { return words::aim(++id, aim); },
                                [&] { return backend.aims() > 10; }));
  EXPECT_FLOAT_EQ(static_cast<float>(backend.record(0).exercise.values[3]), 0.03F);
  ASSERT_TRUE(g.fast->until([&] { return g.fast->game.last.holds_controls; }));
}

TEST_F(UdpBridgeOnLoopback, SignsOfLifeByDatagram_KeepTheControls) {
  WholeGame g(*server, bridge, 60);
  ASSERT_TRUE(g.answerTo(words::takeControls(1)).accepted);
  // Waits for three times the silence that loses the controls, counted in sent states.
  ASSERT_TRUE(g.fast->until([&] { return bridge.counters().states_sent >= 6; }));
  EXPECT_EQ(backend.holderAlive(), 1.0);
  while (backend.holderAlive() == 1.0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  while (controls.holder() != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST_F(UdpBridgeOnLoopback, AimWithoutTheControls_IsRefusedOnceByWebSocket) {
  WholeGame g(*server, bridge, 0);
  std::uint32_t id = 0;
  const auto before = bridge.counters().received.load();
  ASSERT_TRUE(g.fast->sendUntil([&] { return words::aim(++id, {0.1F}); },
                                [&] { return bridge.counters().received > before + 20; }));
  EXPECT_EQ(replies::answer(g.socket).refusal, fb::Refusal::NotHolder);
  g.socket.send(words::setHelp(id + 1, fb::Help::Some));
  EXPECT_EQ(replies::answer(g.socket).command, id + 1) << "no aim was refused a second time";
  EXPECT_EQ(backend.aims(), 0);
}

TEST_F(UdpBridgeOnLoopback, EmergencyStop_IsObeyedWithoutTheControlsAndReported) {
  const WholeGame holder(*server, bridge, 0);
  const WholeGame g(*server, bridge, 1000);
  ASSERT_TRUE(g.fast->sendUntil([] { return words::emergencyStop(77); },
                                [&] { return g.fast->game.last.rate_or_stop == 77; }));
  EXPECT_EQ(backend.status().run_state, RunState::kStopped);
  EXPECT_EQ(backend.status().endings, 2U) << "however often it was repeated";
}

TEST_F(UdpBridgeOnLoopback, EndOfTheWebSocket_EndsTheDatagrams) {
  std::unique_ptr<SocketGame> fast;
  {
    WholeGame g(*server, bridge, 1000);
    ASSERT_TRUE(g.fast->until([&] { return !g.fast->game.state_ticks.empty(); }));
    fast = std::move(g.fast);
  }
  ASSERT_TRUE(fast->until([&] { return bridge.counters().ignoredFor(UdpIgnored::kKey) > 0; }));
  EXPECT_EQ(bridge.counters().peers, 0U);
}

TEST_F(UdpBridgeOnLoopback, GameThatNeverReads_DoesNotBlockPublish) {
  const WholeGame g(*server, bridge, 1000);
  ASSERT_TRUE(g.fast->until([&] { return !g.fast->game.state_ticks.empty(); }));
  const auto before = bridge.counters().states_sent.load();
  // Sends forty times the capacity of its buffer; a blocking send would never return.
  for (std::uint64_t tick = 1; tick <= 20'000; ++tick) {
    bridge.publish(backend.record(tick));
    if (tick % 1000 == 0) g.fast->game.send();
  }
  EXPECT_GE(bridge.counters().states_sent, before + 1000);
}

TEST_F(UdpBridgeOnLoopback, OversizedDatagram_IsCounted) {
  SocketGame g(bridge.local(), 1, 0);
  ASSERT_EQ(g.socket.send(g.to, TestGame::Bytes(3000, 1)), UdpSent::kSent);
  ASSERT_TRUE(g.until([&] { return bridge.counters().ignoredFor(UdpIgnored::kTooLong) == 1; }));
  EXPECT_EQ(g.game.heard, 0);
}

TEST_F(UdpBridgeOnLoopback, ManyGamesAtOnce_GetOnlyTheirOwnMessages) {
  std::atomic<bool> stopping{false};
  std::thread telemetry([&] {
    for (std::uint64_t tick = 1; !stopping; ++tick) {
      bridge.publish(backend.record(tick));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  std::vector<std::thread> games;
  std::atomic<int> done{0};
  for (int i = 0; i < 4; ++i) {
    games.emplace_back([&] {
      const WholeGame g(*server, bridge, 100);
      auto& reported = g.fast->game.state_ticks;
      if (g.fast->until([&] { return reported.size() >= 20; }) &&
          std::is_sorted(reported.begin(), reported.end())) {
        ++done;
      }
    });
  }
  for (auto& t : games) t.join();
  stopping = true;
  telemetry.join();
  EXPECT_EQ(done, 4);
  bridge.stop();
  bridge.publish(backend.record(1));  // after the end: no effect
}

class UdpBridgeWithAKey : public UdpBridgeOnLoopback {
 protected:
  UdpBridgeWithAKey() : UdpBridgeOnLoopback(kKeyOfTheStart) {}
};

TEST_F(UdpBridgeWithAKey, GameWithoutAWebSocket_CanTakeTheControlsAimAndStop) {
  SocketGame g(bridge.local(), kKeyOfTheStart, 200);
  std::uint32_t id = 0;
  ASSERT_TRUE(g.sendUntil([&] { return words::takeControls(++id); },
                          [&] { return g.game.last.holds_controls; }));
  ASSERT_TRUE(g.sendUntil([&] { return words::steer(++id, fb::Steering::Person); },
                          [&] {
                            return !g.game.last_state.empty() &&
                                   g.game.state().steering() == fb::Steering::Person;
                          }));
  const std::vector<float> aim(9, 0.02F);
  ASSERT_TRUE(
      g.sendUntil([&] { return words::aim(++id, aim); }, [&] { return backend.aims() > 10; }));
  const std::uint32_t stop = ++id;
  ASSERT_TRUE(g.sendUntil([&] { return words::emergencyStop(stop); },
                          [&] { return g.game.last.rate_or_stop == stop; }));
  EXPECT_EQ(backend.status().run_state, RunState::kStopped);
  // The game falls silent and loses the controls like any client.
  while (controls.holder() != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  while (backend.holderAlive() == 1.0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST(UdpBridgeOptions, TakenPort_IsRefusedWithAMessage) {
  FakeBackend backend;
  ControlHolder controls;
  UdpBridge first(backend, controls), second(backend, controls);
  ASSERT_TRUE(first.start({kAnyPort}).ok());
  const auto taken = second.start({first.local()});
  ASSERT_FALSE(taken.ok());
  EXPECT_NE(format(taken.errors()).find("cannot be listened to"), std::string::npos);
}

TEST(UdpKeyText, ValidTexts_AreReadAndInvalidOnesRefused) {
  const auto good = parseUdpKey("fedcba9876543210");
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(*good, kKeyOfTheStart);
  for (const char* bad : {"", "0", "0000000000000000", "fedcba987654321", "fedcba98765432100",
                          "0xdcba9876543210", "fedcba987654321g", " edcba9876543210"}) {
    const auto refused = parseUdpKey(bad);
    ASSERT_FALSE(refused.ok()) << bad;
    EXPECT_NE(format(refused.errors()).find("16 hexadecimal digits"), std::string::npos);
  }
}

TEST(UdpMetrics, Text_NamesEveryReasonOnce) {
  UdpCounters counters;
  for (int i = 0; i < static_cast<int>(UdpIgnored::kCount); ++i) {
    for (int n = 0; n <= i; ++n) counters.ignore(static_cast<UdpIgnored>(i));
  }
  const std::string text = udpMetricsText(counters);
  for (int i = 0; i < static_cast<int>(UdpIgnored::kCount); ++i) {
    const std::string line = std::string("wholehand_udp_ignored_total{reason=\"") +
                             udpIgnoredName(static_cast<UdpIgnored>(i)) + "\"} " +
                             std::to_string(i + 1) + "\n";
    const auto at = text.find(line);
    EXPECT_NE(at, std::string::npos) << line;
    EXPECT_EQ(text.find(line, at + 1), std::string::npos) << line;
  }
}

TEST(UdpEndpointText, ValidTexts_AreReadAndInvalidOnesRefused) {
  const auto good = parseUdpEndpoint("127.0.0.1:8091");
  ASSERT_TRUE(good.ok());
  EXPECT_EQ(format(*good), "127.0.0.1:8091");
  EXPECT_EQ(parseUdpEndpoint("10.0.0.5")->port, 0);
  for (const char* bad : {"", ":80", "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:70000",
                          "127.0.0.1:80x", "no such host:1"}) {
    EXPECT_FALSE(parseUdpEndpoint(bad).ok()) << bad;
  }
}

}  // namespace
}  // namespace wholehand
