#include "station/server/client_words.hpp"
#include "station/server/fake_program.hpp"
#include "station/server/raw_client.hpp"
#include "support/bar_station.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>

// A game registers a thousand bodies over its WebSocket and draws at 60 Hz. Measures the age of the
// drawn states. The wall time is printed only; the test checks how many states came.
namespace wholehand::test {
namespace {

namespace fb = wholehand::protocol;
using replies::message;

constexpr double kFrame_ms = 1e3 / 60.0;

struct Drawn {
  std::vector<double> ages_ms;  ///< age of the newest state at every frame
  std::size_t states = 0, bodies = 0, registered = 0, in_slots = 0, left_out = 0;
};

/// Reads the messages that have come and waits no longer than the rest of the frame.
void listen(WebSocket& socket, std::chrono::steady_clock::time_point until, Drawn& drawn,
            std::int64_t& newest_ns, std::map<std::uint32_t, fb::Whereabouts>& where) {
  while (std::chrono::steady_clock::now() < until) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        until - std::chrono::steady_clock::now());
    const auto frame = socket.receive(std::max(left, 1ms));
    if (!frame) continue;
    if (const auto* state = message(*frame).payload_as_WorldState()) {
      newest_ns = state->sent_monotonic_ns();
      drawn.bodies = state->bodies()->size();
      ++drawn.states;
    }
    const auto* reported = message(*frame).payload_as_GameBodies();
    if (reported == nullptr || reported->registered() == nullptr) continue;
    for (const auto* body : *reported->registered()) where[body->number()] = body->whereabouts();
  }
}

/// Registers the bodies around the hand as a game does: 64 per message.
void registerAll(WebSocket& socket, std::uint32_t& id) {
  auto random = seededRandom(5405);
  std::uniform_real_distribution<float> unit(-0.6F, 0.6F);
  socket.send(words::takeControls(++id));
  socket.send(words::prepareBall(++id, 0, 0.025F));
  for (int first = 0; first < kMostRegistered; first += 64) {
    std::vector<words::SpawnWords> balls;
    for (int i = first; i < std::min(first + 64, kMostRegistered); ++i) {
      words::SpawnWords ball;
      ball.slot = static_cast<std::uint16_t>(kFirstNumber + i);
      ball.owner = i % 4 == 0 ? fb::BodyOwner::Game : fb::BodyOwner::Fixed;
      const float x = unit(random), y = unit(random), z = unit(random);
      ball.pose = words::placed(x, y, z);
      balls.push_back(ball);
    }
    socket.send(words::spawn(++id, balls));
  }
}

Drawn draw(std::uint16_t port, int frames) {
  WebSocket socket(port);
  std::uint32_t id = 0;
  registerAll(socket, id);
  Drawn drawn;
  std::int64_t newest_ns = 0;
  std::map<std::uint32_t, fb::Whereabouts> where;
  auto due = std::chrono::steady_clock::now();
  for (int frame = -60; frame < frames;
       ++frame) {  // the first 60 frames are not counted: all bodies arrive
    listen(socket, due, drawn, newest_ns, where);
    due += std::chrono::microseconds(16'667);
    if (frame % 3 == 0) socket.send(words::heartbeat(0));
    if (frame < 0) continue;
    drawn.ages_ms.push_back(1e-6 * static_cast<double>(monotonicNow_ns() - newest_ns));
  }
  for (const auto& [number, whereabouts] : where) {
    ++drawn.registered;
    drawn.in_slots += whereabouts == fb::Whereabouts::InSlot ? 1 : 0;
    drawn.left_out += whereabouts == fb::Whereabouts::LeftOut ? 1 : 0;
  }
  return drawn;
}

TEST(StationLoad, ThousandBodiesOfAGame_AreDrawnInTheirPresentState) {
  StationConfig config = barStation();
  config.files.exercise = std::string(WHOLEHAND_SOURCE_DIR) + "/config/exercises/game-scene.toml";
  config.rehearse = false;
  Station station(config);
  (void)orThrow(station.load());
  ControlHolder controls;
  ServerOptions options;
  options.port = 0;
  auto server = orThrow(Server::open(station, options, controls));
  station.addSink([&](const TickRecord& record) { server->publish(record); });
  std::thread loop([&] { (void)station.run(true, 0.0); });
  while (station.status().ticks < 500) std::this_thread::sleep_for(10ms);
  Drawn drawn = draw(server->port(), cases(300));
  const LoopStatus status = station.status();
  station.quit();
  loop.join();
  server.reset();
  std::sort(drawn.ages_ms.begin(), drawn.ages_ms.end());
  ASSERT_FALSE(drawn.ages_ms.empty());
  const double p99_ms = drawn.ages_ms[drawn.ages_ms.size() * 99 / 100];
  figure("registered bodies", static_cast<double>(drawn.registered), "bodies");
  figure("with a slot", static_cast<double>(drawn.in_slots), "bodies");
  figure("left out", static_cast<double>(drawn.left_out), "bodies");
  figure("newest state at a frame, p50", drawn.ages_ms[drawn.ages_ms.size() / 2], "ms");
  figure("newest state at a frame, p99", p99_ms / kFrame_ms, "frames of 60 Hz");
  figure("tick p99.9 of the session", status.cpu_p999_us, "us of CPU");
  EXPECT_EQ(drawn.registered, static_cast<std::size_t>(kMostRegistered));
  EXPECT_GT(drawn.in_slots, 20U);
  EXPECT_GE(drawn.bodies, drawn.in_slots);
  EXPECT_GT(drawn.states, 100U);
}

}  // namespace
}  // namespace wholehand::test
