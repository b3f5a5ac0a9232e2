// The whole program as `wholehand run` assembles it: loop, telemetry, recording, server and UDP
// bridge, with clients on all of its ports. ./check runs it under ThreadSanitizer.
#include "record/recording.hpp"
#include "station/server/client_words.hpp"
#include "station/server/fake_program.hpp"
#include "station/server/raw_client.hpp"
#include "station/server/udp_bridge.hpp"
#include "station/server/udp_test_game.hpp"
#include "support/bar_station.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"
#include "support/watched_main.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <optional>
#include <thread>

namespace wholehand::test {
namespace {

namespace fb = wholehand::protocol;
using Clock = std::chrono::steady_clock;

StationConfig barConfig(const std::string& folder) {
  StationConfig c = barStation();
  c.recordings_folder = folder + "/recordings";
  return c;
}

/// The console of a therapist who holds the controls.
class Console {
 public:
  explicit Console(std::uint16_t port) : socket_(port) {}

  /// Sends one command and returns whether it was accepted.
  template <class Word, class... Arguments>
  bool ask(Word word, Arguments... arguments) {
    const std::uint32_t id = ++id_;
    socket_.send(word(id, arguments...));
    std::optional<bool> accepted;
    (void)staysUntil([&] { return accepted.has_value(); },
                     [&](const fb::Reply& reply) {
                       if (reply.command() != id) return;
                       if (!reply.accepted()) std::printf("refused: %s\n", reply.reason()->c_str());
                       accepted = reply.accepted();
                     });
    return accepted.value_or(false);
  }
  /// Reads messages and sends heartbeats until the condition holds.
  template <class Condition>
  bool staysUntil(
      Condition&& condition,
      const std::function<void(const fb::Reply&)>& hears = [](const fb::Reply&) {}) {
    for (const auto until = Clock::now() + kPatience; Clock::now() < until && !condition();) {
      // A console that is silent for 200 ms is suspended.
      const auto frame = socket_.receive(50ms);
      if (frame && frame->opcode == 2) {
        if (const auto* reply = replies::message(*frame).payload_as_Reply()) hears(*reply);
      }
      if (socket_.closed()) {
        std::printf("the program has closed the console's connection\n");
        return false;
      }
      socket_.send(words::heartbeat(++id_));
    }
    return condition();
  }

 private:
  WebSocket socket_;
  std::uint32_t id_ = 0;
};

/// Threads of watching clients, until the object is destroyed.
class Watchers {
 public:
  Watchers(std::uint16_t http, const UdpEndpoint& udp) {
    for (int i = 0; i < 2; ++i) {
      threads_.emplace_back([this, http] {
        WebSocket socket(http);
        while (!leaving_) {
          if (socket.receive(100ms)) ++frames;
          if (socket.closed()) break;
        }
      });
    }
    threads_.emplace_back([this, http] { browse(http); });
    threads_.emplace_back([this, http, udp] { play(http, udp); });
  }
  ~Watchers() {
    leaving_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  Watchers(const Watchers&) = delete;
  Watchers& operator=(const Watchers&) = delete;

  std::atomic<int> frames{0}, pages{0}, states{0};

 private:
  void browse(std::uint16_t http) {
    try {
      while (!leaving_) {
        if (get(http, "/metrics").status == 200) ++pages;
        (void)get(http, "/api/recordings");
        std::this_thread::sleep_for(20ms);
      }
    } catch (const std::runtime_error&) {  // the program has ended
    }
  }
  void play(std::uint16_t http, const UdpEndpoint& udp) {
    WebSocket line(http);
    const auto frame = replies::next(line, fb::Payload::Welcome);
    UdpSocket socket;
    if (!frame || !socket.open({0x7F000001, 0})) return;
    TestGame game([&](const TestGame::Bytes& d) { (void)socket.send(udp, d); });
    game.key = replies::message(*frame).payload_as_Welcome()->udp_key();
    game.rate_hz = 100;
    std::array<std::uint8_t, 2000> buffer{};
    UdpEndpoint from;
    while (!leaving_ && !line.closed()) {
      for (long n; (n = socket.receive(from, buffer)) >= 0;) {
        game.receive({buffer.data(), static_cast<std::size_t>(n)});
      }
      states = static_cast<int>(game.state_ticks.size());
      game.send();
      (void)line.receive(20ms);
    }
  }

  std::atomic<bool> leaving_{false};
  std::vector<std::thread> threads_;
};

/// The program, assembled as by `wholehand run`.
struct Program {
  explicit Program(const std::string& folder)
      : station(barConfig(folder)), bridge(station, controls) {
    seesRealTime();
    (void)orThrow(station.load());
    ServerOptions options;
    options.port = 0;
    options.log = [](const std::string& line) { std::printf("server: %s\n", line.c_str()); };
    options.more_metrics = [this] { return udpMetricsText(bridge.counters()); };
    (void)orThrow(bridge.start({{0x7F000001, 0}}));
    options.udp = &bridge;
    server = orThrow(Server::open(station, options, controls));
    station.addSink([this](const TickRecord& record) { bridge.publish(record); });
    station.addSink([this](const TickRecord& record) { server->publish(record); });
    station.addSink([this](const TickRecord&) { ++records; });
    keeper = std::thread([this] { ended_well = station.run(false, 0.0).ok(); });
  }
  ~Program() { quit(); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  void quit() {
    if (!keeper.joinable()) return;
    station.quit();
    keeper.join();
    bridge.stop();
    server.reset();
  }
  Station station;
  ControlHolder controls;
  UdpBridge bridge;
  std::unique_ptr<Server> server;
  std::atomic<std::uint64_t> records{0};
  std::atomic<bool> ended_well{false};
  std::thread keeper;
};

bool becomes(Program& program, Console& console, RunState state) {
  return console.staysUntil([&] { return program.station.status().run_state == state; });
}

bool rendersOn(Program& program, Console& console) {
  const std::uint64_t before = program.records;
  return becomes(program, console, RunState::kRendering) &&
         console.staysUntil([&] { return program.records > before + 200; });
}

void expectNeutral(const Station& station) {
  TickRecord record;
  ASSERT_TRUE(station.latest(record));
  EXPECT_EQ(record.authority, 0.0) << kAlways;
  for (double effort : record.sent)
    EXPECT_EQ(effort, 0.0) << kAlways;  // the neutral effort of this device
}

void expectSoundRecordings(const Station& station, std::size_t count) {
  const std::vector<RecordingEntry> recordings = station.recordings();
  EXPECT_EQ(recordings.size(), count);
  for (const RecordingEntry& entry : recordings) {
    const auto recording = RecordingReader::open(station.recordingPath(entry.name));
    ASSERT_TRUE(recording) << format(recording.errors());
    EXPECT_GT((*recording)->size(), 200U) << entry.name;
  }
}

/// Arms again as a person who has seen the end of the last session.
bool armsAgain(const Station& station, Console& console) {
  return console.ask([seen = station.status()](std::uint32_t id) {
    return words::armAcknowledging(seen.endings, id, seen.basis);
  });
}

TEST(WholeSession, AllPartsAtOnce_ObeyStopsAndRecord) {
  const Folder folder;
  Program program(folder.path());
  Station& station = program.station;
  const Watchers watchers(program.server->port(), program.bridge.local());
  Console console(program.server->port());
  ASSERT_TRUE(console.ask(words::takeControls, ""));

  ASSERT_TRUE(armsAgain(station, console));
  ASSERT_TRUE(rendersOn(program, console));
  EXPECT_TRUE(console.ask(words::setParameter, "effort_limit_arm_n", 8.0, 1U));
  EXPECT_FALSE(console.ask(words::setParameter, "effort_limit_arm_n", 1e6, 1U));
  EXPECT_TRUE(console.ask(words::steer, fb::Steering::Person));
  for (int i = 0; i < 20; ++i) {
    const std::vector<float> aim{-0.06F, 0.0F, 0.001F * static_cast<float>(i), 0.2F, 0.2F, 0.2F};
    EXPECT_TRUE(console.ask(words::aim, aim, fb::Help::Unspecified));
  }
  EXPECT_TRUE(console.ask(words::steer, fb::Steering::VirtualPatient));
  EXPECT_TRUE(
      console.ask(words::action, fb::Act::Restart, station.status().basis, std::uint8_t{0}));
  ASSERT_TRUE(rendersOn(program, console));

  ASSERT_TRUE(console.ask(words::load, "cocktail-bar", std::uint16_t{2}, "woman-p05-right"));
  ASSERT_TRUE(rendersOn(program, console));
  ASSERT_TRUE(console.ask(words::stop));
  ASSERT_TRUE(becomes(program, console, RunState::kStopped));
  expectNeutral(station);

  ASSERT_TRUE(armsAgain(station, console));
  ASSERT_TRUE(rendersOn(program, console));
  ASSERT_TRUE(console.ask(words::emergencyStop));
  ASSERT_TRUE(becomes(program, console, RunState::kStopped));
  expectNeutral(station);

  ASSERT_TRUE(armsAgain(station, console));
  ASSERT_TRUE(rendersOn(program, console));
  program.quit();  // quits while everything runs
  EXPECT_TRUE(program.ended_well);
  expectSoundRecordings(station, 4);  // armed three times, loaded once
  EXPECT_GT(watchers.frames, 10);
  EXPECT_GT(watchers.pages, 5);
  EXPECT_GT(watchers.states, 10);
}

}  // namespace
}  // namespace wholehand::test
