#include "station/server/clients.hpp"
#include "station/server/fake_program.hpp"
#include "station/server/sample_facts.hpp"
#include "station/server/udp_host.hpp"
#include "station/server/udp_test_game.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

// Stop, Rest and EmergencyStop from every role, over both lines, with any holder of the controls,
// in every state and with standstills of the program, on a simulated clock and network. Rules
// (docs/protocol.md, "Roles"): every client may send EmergencyStop; every client but a watcher may
// send Stop and Rest; a Rest without the controls is a plain Stop.
namespace wholehand::test {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// A line that stores the messages to one client.
class RecordingConnection final : public ClientConnection {
 public:
  void deliver(SharedBytes message) override {
    const auto* said = fb::GetMessage(message->data());
    if (const auto* reply = said->payload_as_Reply()) {
      replies[reply->command()] = {
          reply->accepted(), reply->reason()->str(), static_cast<Refusal>(reply->refusal()), {}};
    } else if (const auto* scene = said->payload_as_Scene()) {
      level = scene->level();
    }
  }
  [[nodiscard]] bool offer(SharedBytes message, std::int64_t) override {
    const auto* state = fb::GetMessage(message->data())->payload_as_WorldState();
    if (state != nullptr) basis = state->basis();
    return true;
  }
  [[nodiscard]] std::size_t waiting() const override { return 0; }
  [[nodiscard]] std::int64_t writingSince_ns() const override { return writing_since_ns; }
  [[nodiscard]] std::string address() const override { return "here"; }
  void close(const std::string&) override { was_cut = true; }
  void cut() override { was_cut = true; }

  std::map<std::uint32_t, OrderReply> replies;
  std::uint32_t level = 0, basis = 0;  ///< of the newest scene and state
  std::int64_t writing_since_ns = 0;
  bool was_cut = false;
};

/// A client with a WebSocket and datagrams.
struct Both {
  std::uint32_t number = 0, id = 0;
  Role role = Role::kUnspecified;
  std::shared_ptr<RecordingConnection> connection = std::make_shared<RecordingConnection>();
  std::unique_ptr<TestGame> game;
  UdpEndpoint at;
};

/// The part of the server without sockets, and the messages on their way to it.
class Lines {
 public:
  explicit Lines(std::mt19937_64& random) : random_(random) {
    clients_ = std::make_shared<Clients>(program, mailbox_, traffic_, log_, controls,
                                         Access(ServerOptions{}, 8080),
                                         [](const std::function<void()>& task) { task(); });
  }

  Both& join(Role role) {
    auto& c = *all.emplace_back(std::make_unique<Both>());
    c.role = role;
    c.number = clients_->join(c.connection, role, now_ns);
    c.at = {0x7F000001, static_cast<std::uint16_t>(5000 + c.number)};
    c.game = std::make_unique<TestGame>([](const TestGame::Bytes&) {});
    c.game->key = c.number;
    host_.admit(c.number, c.number, false);
    return c;
  }
  void send(const Both& from, wire::Bytes message) {
    coming_.push_back({from.number, false, std::move(message)});
  }
  void sendDatagram(const Both& from, const wire::Bytes& message = {}) {
    coming_.push_back({from.number, true, from.game->datagram(message)});
  }
  /// One frame of the server; the sockets are read before or after it, at random.
  void frame() {
    const bool first = random_() % 2 == 0;
    if (first) clients_->tick(now_ns);
    readSockets();
    if (!first) clients_->tick(now_ns);
  }
  void pass(std::int64_t ms) { now_ns += ms * kMs; }

  FakeProgram program;
  ControlHolder controls;
  std::int64_t now_ns = 1'000'000 * kMs;
  std::vector<std::unique_ptr<Both>> all;

 private:
  struct OnTheWay {
    std::uint32_t from = 0;
    bool datagram = false;
    wire::Bytes bytes;
  };

  /// Delivers all messages: each line in order, the lines in random order.
  void readSockets() {
    while (!coming_.empty()) {
      const OnTheWay& any = coming_[random_() % coming_.size()];
      const auto next = std::find_if(coming_.begin(), coming_.end(), [&](const OnTheWay& w) {
        return w.from == any.from && w.datagram == any.datagram;
      });
      const OnTheWay one = *next;
      coming_.erase(next);
      if (one.datagram) {
        host_.receive(all[one.from - 1]->at, one.bytes, now_ns);
      } else {
        clients_->receive(one.from, one.bytes, false, now_ns);
      }
    }
    host_.advance(now_ns);
    for (const udp::ReceivedCommand& said : host_.takeCommands()) apply(said);
  }
  void apply(const udp::ReceivedCommand& said) {  // as UdpBridge does
    if (said.order.is<orders::EmergencyStop>()) {
      program.order(said.order, [](const OrderReply&) {});
      host_.finishStop(said, true);
    } else {
      clients_->receiveDatagram(said.client, said.order, now_ns);
    }
  }

  std::mt19937_64& random_;
  EventMailbox mailbox_;
  Traffic traffic_;
  RateLimitedLog log_{[](const std::string&) {}};
  UdpCounters counters_;
  udp::Host host_{controls, counters_,
                  [this](const UdpEndpoint& to, std::span<const std::uint8_t> d) {
                    all[to.port - 5001]->game->receive(d);
                    return UdpSent::kSent;
                  }};
  std::deque<OnTheWay> coming_;
  std::shared_ptr<Clients> clients_;
};

enum class Kind { kStop, kRest, kEmergency };

wire::Bytes words(Kind kind, std::uint32_t id) {
  if (kind == Kind::kStop) return words::stop(id);
  return kind == Kind::kRest ? words::rest(id) : words::emergencyStop(id);
}

/// One random case; checks whether the stop had to be obeyed.
class Draw {
 public:
  explicit Draw(std::mt19937_64& random) : random_(random), lines_(random) {}

  void run() {
    LoopStatus status;
    status.run_state = static_cast<RunState>(random_() % 5);
    status.rested = status.run_state == RunState::kStopped && random_() % 2 == 0;
    if (random_() % 2 == 0) status.device.emplace();
    lines_.program.setStatus(status);
    for (std::size_t left = 2 + random_() % 3; left > 0; --left) {
      Both& c = lines_.join(static_cast<Role>(random_() % 4));
      for (std::size_t known = random_() % 3; known > 0; --known) {
        lines_.sendDatagram(c);
        lines_.frame();
      }
    }
    lines_.frame();
    Both& holder = any();
    lines_.send(holder, words::takeControls(++holder.id));
    lines_.frame();
    ASSERT_EQ(lines_.controls.holder() == holder.number, holder.role != Role::kWatcher);
    Both& stops = any();
    const bool holds = &stops == &holder && holder.role != Role::kWatcher;
    const Kind kind = static_cast<Kind>(random_() % 3);
    const bool by_datagram = random_() % 2 == 0;
    // The id need not rise and need not start at 1.
    const std::uint32_t id = random_() % 4 == 0 ? random_() % 3 : ++stops.id + 1;
    const std::int64_t stands_ms = random_() % 4 == 0 ? 0 : 100 + random_() % 4900;
    const std::int64_t begins_ms = random_() % 1000;
    const std::int64_t ends_ms = begins_ms + stands_ms;
    const std::int64_t stop_ms = random_() % (ends_ms + 500);
    for (std::int64_t ms = 0; ms < ends_ms + 1000; ms += 2) {
      lines_.pass(2);
      if (ms % 50 == 0) beat(holder);
      if (ms == stop_ms / 2 * 2) {
        if (by_datagram) {
          lines_.sendDatagram(stops, words(kind, id));
        } else {
          lines_.send(stops, words(kind, id));
        }
      }
      const bool stands_still = ms >= begins_ms && ms < ends_ms;
      if (!stands_still && ms % 16 == 0) lines_.frame();
    }
    lines_.frame();
    const bool may = kind == Kind::kEmergency || stops.role != Role::kWatcher;
    expectHandedOn(may, kind, kind == Kind::kRest && (holds || status.rested));
    if (!by_datagram) {
      ASSERT_TRUE(stops.connection->replies.contains(id));
      EXPECT_EQ(stops.connection->replies[id].accepted, may);
    }
    if (!may && !by_datagram)
      EXPECT_EQ(stops.connection->replies[id].refusal, Refusal::kOnlyWatches);
    if (holder.role == Role::kWatcher) return;
    EXPECT_EQ(lines_.controls.holder(), holder.number) << "after " << stands_ms << " ms";
    EXPECT_TRUE(lines_.program.askedFor<orders::HolderAlive>(0).empty())
        << "a standstill of our own changes no effort: " << stands_ms << " ms";
  }

 private:
  Both& any() { return *lines_.all[random_() % lines_.all.size()]; }
  void beat(Both& holder) {
    if (random_() % 2 == 0) {
      lines_.send(holder, words::heartbeat(0));
    } else {
      lines_.send(holder, words::heartbeat(0));
      lines_.sendDatagram(holder);
    }
  }
  void expectHandedOn(bool may, Kind kind, bool rest) {
    std::vector<Order> stopped;
    for (const auto& asked : lines_.program.asked()) {
      if (asked.order.stops()) stopped.push_back(asked.order);
    }
    ASSERT_EQ(stopped.size(), may ? 1U : 0U);
    if (!may) return;
    EXPECT_STREQ(stopped[0].row().name, kind == Kind::kEmergency ? "EmergencyStop"
                                        : rest                   ? "Rest"
                                                                 : "Stop");
  }

  std::mt19937_64& random_;
  Lines lines_;
};

TEST(StopLines, StopsOfEveryKindRoleLineAndState_AreObeyed) {
  auto random = seededRandom(3404);
  const int drawn = cases(3000);
  for (int i = 0; i < drawn && !::testing::Test::HasFailure(); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    Draw(random).run();
  }
  figure("stops by every line, role, holder and state, with standstills of 0.1 to 5 s", drawn, "");
}

// A client that repeats its stop is not cut off if the program itself stood still during the write.
TEST(StopLines, WriteThatLastsThroughAStandstill_DoesNotCutTheLine) {
  auto random = seededRandom(3405);
  Lines lines(random);
  Both& c = lines.join(Role::kPlayer);
  lines.frame();
  c.connection->writing_since_ns = lines.now_ns;
  lines.pass(5000);
  lines.frame();
  EXPECT_FALSE(c.connection->was_cut) << "what the client has read meanwhile is seen first";
  lines.pass(16);
  lines.frame();
  EXPECT_TRUE(c.connection->was_cut) << "it reads nothing";
}

// A load happens at any moment of the server's frame. In this test every load has the number of its
// basis as its level. A client that shows basis n has the scene n, or a newer one.
TEST(ShownBasis, LoadAmidAFrame_IsNeverShownWithAnEarlierScene) {
  std::mt19937_64 random = seededRandom(5806);
  Lines lines(random);
  std::uint32_t loaded = 0;
  const auto load = [&] {
    SceneFacts facts = sampleScene();
    facts.level = facts.levels = static_cast<int>(++loaded);
    lines.program.setScene(std::move(facts));
    LoopStatus status;
    status.basis = loaded;
    lines.program.setStatus(status);
  };
  load();
  const Both& client = lines.join(Role::kTherapist);
  const auto sometimes = [&] {
    if (random() % 4 == 0) load();
  };
  lines.program.in_tick = lines.program.in_status = sometimes;
  for (int i = 0; i < cases(2000); ++i) {
    lines.pass(16);
    lines.frame();
    ASSERT_LE(client.connection->basis, client.connection->level);
  }
  lines.program.in_tick = lines.program.in_status = {};
  lines.pass(16);
  lines.frame();
  EXPECT_EQ(client.connection->basis, loaded);
}

struct RestRight : ::testing::Test {
  RestRight() {
    LoopStatus status;
    status.run_state = RunState::kRendering;
    lines.program.setStatus(status);
  }
  Both& player() {
    Both& c = lines.join(Role::kPlayer);
    lines.frame();
    return c;
  }
  OrderReply ask(Both& who, const std::function<wire::Bytes(std::uint32_t)>& order) {
    lines.send(who, order(++who.id));
    lines.frame();
    lines.send(who, words::heartbeat(0));
    return who.connection->replies[who.id];
  }
  OrderReply take(Both& who) {
    return ask(who, [](std::uint32_t id) { return words::takeControls(id); });
  }
  OrderReply rest(Both& who) {
    return ask(who, [](std::uint32_t id) { return words::rest(id); });
  }
  OrderReply arm(Both& who, std::uint32_t seen) {
    return ask(who, [seen](std::uint32_t id) { return words::armAcknowledging(seen, id); });
  }
  /// Sets the status that the station reports after a rest.
  void rests(std::uint32_t endings, bool arming = false, bool before_start = false) {
    LoopStatus status;
    status.run_state = RunState::kStopped;
    status.rested = true;
    status.arming = arming;
    status.rest_before_start = before_start;
    status.endings = endings;
    lines.program.setStatus(status);
    lines.frame();
  }

  std::mt19937_64 random = seededRandom(3406);
  Lines lines{random};
};

TEST_F(RestRight, SecondRestDuringARest_DoesNotTakeTheRight) {
  Both &first = player(), &second = player();
  lines.join(Role::kTherapist);
  ASSERT_TRUE(take(first).accepted);
  ASSERT_TRUE(rest(first).accepted);
  rests(2);
  ASSERT_TRUE(rest(second).accepted) << "without the controls";
  ASSERT_EQ(lines.controls.holder(), 0U) << "a player loses them at every ending";
  ASSERT_TRUE(take(second).accepted);
  ASSERT_TRUE(rest(second).accepted) << "with them";
  EXPECT_EQ(arm(second, 2).refusal, Refusal::kTherapistOnly);
  ASSERT_TRUE(ask(second, [](std::uint32_t id) { return words::releaseControls(id); }).accepted);
  ASSERT_TRUE(take(first).accepted);
  EXPECT_TRUE(arm(first, 2).accepted);
}

TEST_F(RestRight, RestThatCancelsAnArming_GivesTheRightToItsPlayer) {
  Both &first = player(), &second = player();
  lines.join(Role::kTherapist);
  ASSERT_TRUE(take(first).accepted);
  ASSERT_TRUE(rest(first).accepted);
  rests(2, true);  // the therapist arms
  ASSERT_TRUE(take(second).accepted);
  ASSERT_TRUE(rest(second).accepted);
  rests(3);
  ASSERT_TRUE(take(second).accepted);
  EXPECT_TRUE(arm(second, 3).accepted);
}

// Otherwise a player could start a session that no therapist has started, by a rest of nothing.
TEST_F(RestRight, RestBeforeTheFirstStart_GivesOnlyTheRightOfAFirstStart) {
  LoopStatus disarmed;
  lines.program.setStatus(disarmed);
  Both& alone = player();
  ASSERT_TRUE(take(alone).accepted);
  ASSERT_TRUE(rest(alone).accepted);
  rests(2, false, true);
  ASSERT_TRUE(take(alone).accepted);
  EXPECT_TRUE(arm(alone, 2).accepted);
  lines.join(Role::kTherapist);
  lines.frame();
  EXPECT_EQ(arm(alone, 2).refusal, Refusal::kTherapistOnly);
}

}  // namespace
}  // namespace wholehand::test
