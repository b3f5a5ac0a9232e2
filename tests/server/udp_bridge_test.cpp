#include "server/udp_bridge.hpp"

#include "realtime/monotonic_clock.hpp"
#include "server/udp_fake_backend.hpp"
#include "server/udp_test_game.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

// The bridge on real sockets. Nothing here depends on how fast the machine is: what is late is
// waited for.
namespace wholehand {
namespace {

using test::FakeBackend;
using test::TestGame;
namespace words = test::words;

constexpr UdpEndpoint kAnyPort{0x7F000001, 0};

void rest(int ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

/// A game with a socket.
struct SocketGame {
  explicit SocketGame(const UdpEndpoint& program) : to(program) {
    if (!socket.open(kAnyPort)) throw std::runtime_error("no socket");
  }
  /// Hears all that waits; true when the condition comes true within 20 s.
  template <class Condition>
  bool until(Condition condition) {
    std::array<std::uint8_t, 2000> buffer;
    UdpEndpoint from;
    for (const std::int64_t end = monotonicNow_ns() + 20'000'000'000; monotonicNow_ns() < end;) {
      for (long n; (n = socket.receive(from, buffer)) >= 0;) {
        game.hear({buffer.data(), static_cast<std::size_t>(n)});
      }
      if (condition()) return true;
      socket.wait(5);
    }
    return false;
  }
  bool connect(std::uint16_t rate_hz) {
    game.hello(rate_hz);
    return until([&] { return game.session != 0 && !game.reliable.empty(); });
  }

  UdpEndpoint to;
  UdpSocket socket;
  TestGame game{[this](const TestGame::Bytes& d) {
    if (socket.send(to, d) != UdpSent::kSent) throw std::runtime_error("not sent");
  }};
};

class UdpBridgeOnLoopback : public ::testing::Test {
 protected:
  UdpBridgeOnLoopback() : bridge(backend, controls) {
    UdpOptions options;
    options.local = kAnyPort;
    const auto started = bridge.start(options);
    if (!started) throw std::runtime_error(format(started.errors()));
  }
  FakeBackend backend;
  ControlsArbiter controls;
  UdpBridge bridge;
};

TEST_F(UdpBridgeOnLoopback, EveryTick_ReachesTheGameInOrder) {
  SocketGame g(bridge.local());
  ASSERT_TRUE(g.connect(1000));
  for (std::uint64_t tick = 1; tick <= 3000; ++tick) {
    bridge.publish(backend.record(tick));
    // The game's buffer holds some hundred: it reads before it is full, however slow this goes.
    if (tick % 50 == 0) {
      // On a busy machine one that says how the loop was before its first record may come last.
      const auto& told = g.game.state_ticks;
      ASSERT_TRUE(g.until([&] { return std::find(told.begin(), told.end(), tick) != told.end(); }));
    }
  }
  std::erase(g.game.state_ticks, 0U);  // how the loop was before its first record
  ASSERT_EQ(g.game.state_ticks.size(), 3000U);
  for (std::uint64_t i = 0; i < 3000; ++i) ASSERT_EQ(g.game.state_ticks[i], i + 1);
  EXPECT_EQ(bridge.counters().dropped_full, 0U);
}

// A game that is to start the loop has to know what ended before.
TEST_F(UdpBridgeOnLoopback, BeforeTheFirstRecord_StatesSayHowTheLoopIs) {
  SocketGame g(bridge.local());
  ASSERT_TRUE(g.connect(60));
  ASSERT_TRUE(g.until([&] { return g.game.state_ticks.size() >= 2; }));
  g.game.command(words::takeControls(1));
  g.game.command(words::emergencyStop(2));
  ASSERT_TRUE(g.until([&] { return g.game.replies().count(2) != 0; }));
  g.game.command(words::armHavingSeen(1, 3));
  g.game.command(words::armHavingSeen(2, 4));
  ASSERT_TRUE(g.until([&] { return g.game.replies().count(4) != 0; }));
  EXPECT_FALSE(g.game.replies().at(3).first) << "it was pressed before the stop was shown";
  EXPECT_TRUE(g.game.replies().at(4).first);
}

TEST_F(UdpBridgeOnLoopback, GameThatNeverReads_DoesNotHoldUpPublish) {
  SocketGame g(bridge.local());
  ASSERT_TRUE(g.connect(1000));
  // Forty times what its buffer holds; a send that blocks would never come back.
  for (std::uint64_t tick = 1; tick <= 20'000; ++tick) {
    bridge.publish(backend.record(tick));
    if (tick % 1000 == 0) g.game.say(udp::Kind::kHeartbeat);
  }
  EXPECT_GE(bridge.counters().states_sent, 20'000U);  // and some before the first record
}

TEST_F(UdpBridgeOnLoopback, Commands_ReachTheBackendAndAreAnswered) {
  SocketGame g(bridge.local());
  ASSERT_TRUE(g.connect(0));
  g.game.command(words::takeControls(1));
  ASSERT_TRUE(g.until([&] { return g.game.replies().count(1) != 0; }));
  g.game.command(words::setParameter(2, "lead_in_m", 0.012));
  ASSERT_TRUE(g.until([&] { return g.game.replies().count(2) != 0; }));
  EXPECT_TRUE(g.game.replies().at(2).first);
  EXPECT_EQ(backend.record(0).exercise.values[0], 0.012);
}

TEST_F(UdpBridgeOnLoopback, SilentGame_FadesTheExerciseOutUntilItTakesTheControlsAnew) {
  SocketGame g(bridge.local());
  ASSERT_TRUE(g.connect(0));
  g.game.command(words::takeControls(1));
  ASSERT_TRUE(g.until([&] { return g.game.replies().count(1) != 0; }));
  ASSERT_TRUE(g.until([&] { return backend.ownerAlive() == 0.0; }));
  g.game.say(udp::Kind::kHeartbeat);
  g.game.command(words::takeControls(2));
  ASSERT_TRUE(g.until([&] { return backend.ownerAlive() == 1.0; }));
}

TEST_F(UdpBridgeOnLoopback, ProgramThatThrows_LosesNobodyAndNoEmergencyStop) {
  SocketGame g(bridge.local());
  ASSERT_TRUE(g.connect(0));
  g.game.command(words::takeControls(1));
  ASSERT_TRUE(g.until([&] { return g.game.replies().count(1) != 0; }));
  g.game.command(words::setParameter(2, "throw", 0.5));
  g.game.command(words::emergencyStop(3));
  ASSERT_TRUE(g.until([&] { return g.game.replies().count(2) + g.game.replies().count(3) == 2; }));
  EXPECT_FALSE(g.game.replies().at(2).first);
  EXPECT_TRUE(g.game.replies().at(3).first);
  EXPECT_EQ(backend.status().run_state, RunState::kStopped);
  EXPECT_EQ(bridge.counters().exceptions, 1U);
}

TEST_F(UdpBridgeOnLoopback, OversizedDatagram_IsCounted) {
  SocketGame g(bridge.local());
  const TestGame::Bytes large(3000, 1);
  ASSERT_EQ(g.socket.send(g.to, large), UdpSent::kSent);
  ASSERT_TRUE(g.until([&] { return bridge.counters().ignoredFor(UdpIgnored::kTooLong) == 1; }));
}

TEST_F(UdpBridgeOnLoopback, ManyGamesAtOnceWhileRecordsCome_NothingIsMixedUp) {
  std::atomic<bool> stopping{false};
  std::thread telemetry([&] {
    for (std::uint64_t tick = 1; !stopping; ++tick) {
      bridge.publish(backend.record(tick));
      rest(1);
    }
  });
  std::vector<std::thread> games;
  std::atomic<int> done{0};
  for (int i = 0; i < 4; ++i) {
    games.emplace_back([&, i] {
      SocketGame g(bridge.local());
      g.game.hello(100, "", 100U + static_cast<unsigned>(i));
      const bool all = g.until([&] {
        g.game.say(udp::Kind::kHeartbeat);
        return g.game.state_ticks.size() >= 20;
      });
      g.game.say(udp::Kind::kGoodbye);
      if (all && std::is_sorted(g.game.state_ticks.begin(), g.game.state_ticks.end())) ++done;
    });
  }
  for (auto& t : games) t.join();
  stopping = true;
  telemetry.join();
  EXPECT_EQ(done, 4);
  bridge.stop();
  bridge.publish(backend.record(1));  // after the end: nothing happens
}

/// A backend that answers when it is asked to, from another thread.
class LateBackend : public FakeBackend {
 public:
  void order(const Order& order, std::function<void(OrderReply)> done) override {
    if (order.type != OrderType::kArm) return FakeBackend::order(order, done);
    const std::lock_guard lock(mutex);
    waiting.push_back(std::move(done));
  }
  bool answerAll() {
    const std::lock_guard lock(mutex);
    for (auto& done : waiting) std::thread([&] { done({true, ""}); }).join();
    return !std::exchange(waiting, {}).empty();
  }
  std::mutex mutex;
  std::vector<std::function<void(OrderReply)>> waiting;
};

TEST(UdpBridgeOrders, AnsweredLate_ReachTheGameAndNobodyAfterTheEnd) {
  LateBackend backend;
  ControlsArbiter controls;
  auto bridge = std::make_unique<UdpBridge>(backend, controls);
  UdpOptions options;
  options.local = kAnyPort;
  ASSERT_TRUE(bridge->start(options).ok());
  SocketGame g(bridge->local());
  ASSERT_TRUE(g.connect(0));
  g.game.command(words::takeControls(1));
  g.game.command(words::arm(2));
  ASSERT_TRUE(g.until([&] { return g.game.replies().count(1) != 0 && backend.answerAll(); }));
  ASSERT_TRUE(g.until([&] { return g.game.replies().count(2) != 0; }));
  EXPECT_TRUE(g.game.replies().at(2).first);
  g.game.command(words::arm(3));
  ASSERT_TRUE(g.until([&] {
    const std::lock_guard lock(backend.mutex);
    return !backend.waiting.empty();
  }));
  bridge = nullptr;
  EXPECT_TRUE(backend.answerAll());  // must find nobody, and nothing that is gone
}

TEST(UdpBridgeOptions, ThatCannotBe_AreRefusedInWords) {
  FakeBackend backend;
  ControlsArbiter controls;
  UdpBridge first(backend, controls), second(backend, controls), third(backend, controls);
  UdpOptions options;
  options.local = kAnyPort;
  ASSERT_TRUE(first.start(options).ok());
  options.local = first.local();
  const auto taken = second.start(options);
  ASSERT_FALSE(taken.ok());
  EXPECT_NE(format(taken.errors()).find("cannot be listened to"), std::string::npos);

  options.local = {0, 0};  // every address of this machine
  options.token = "short";
  const auto open = third.start(options);
  ASSERT_FALSE(open.ok());
  EXPECT_NE(format(open.errors()).find("token"), std::string::npos);
  options.local = kAnyPort;
  options.peers = {{0x0A000005, 9000}};
  EXPECT_NE(format(third.start(options).errors()).find("10.0.0.5:9000"), std::string::npos);
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

TEST(UdpEndpointText, GoodAndBad) {
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
