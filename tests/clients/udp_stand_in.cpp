// Stands in for the program: a server and a UdpBridge whose records come at 1 kHz from a fake
// backend, as telemetry delivers them. udp_stand_in [port] [token] prints the port of its pages,
// then runs until its standard input ends, and prints how late it was itself, so that a client on a
// busy machine is judged fairly. Port "closed:N" serves pages at N and no datagrams.

#include "loop/realtime/monotonic_clock.hpp"
#include "station/server/server.hpp"
#include "station/server/udp_bridge.hpp"
#include "station/server/udp_fake_backend.hpp"

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr std::int64_t kPeriod_ns = 1'000'000;
constexpr std::uint64_t kTicksBetweenEvents = 250;

void sleepUntil(std::int64_t at_ns) {
  timespec t{};
  t.tv_sec = at_ns / 1'000'000'000;
  t.tv_nsec = at_ns % 1'000'000'000;
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr);
}

/// A backend whose newest record is the one made last.
class Program : public wholehand::test::FakeBackend {
 public:
  [[nodiscard]] bool latest(wholehand::TickRecord& out) const override {
    out = record(tick);
    return true;
  }
  std::atomic<std::uint64_t> tick{0};
};

/// Publishes every due tick, in batches if it is late, as telemetry does.
std::vector<std::int64_t> publish(wholehand::UdpBridge& bridge, wholehand::Server& server,
                                  Program& backend, const std::atomic<bool>& stopping) {
  std::vector<std::int64_t> lateness_ns;
  lateness_ns.reserve(200'000);
  const std::int64_t start_ns = wholehand::monotonicNow_ns();
  for (std::uint64_t tick = 0; !stopping; ++tick) {
    const std::int64_t due_ns = start_ns + static_cast<std::int64_t>(tick) * kPeriod_ns;
    if (wholehand::monotonicNow_ns() < due_ns) sleepUntil(due_ns);
    wholehand::TickRecord record = backend.record(tick);
    if (tick % kTicksBetweenEvents == 0) {
      record.exercise.event_count = 1;
      record.exercise.events[0] = {1, 2, static_cast<double>(tick / kTicksBetweenEvents)};
    }
    backend.tick = tick;
    bridge.publish(record);
    server.publish(record);
    lateness_ns.push_back(wholehand::monotonicNow_ns() - due_ns);
  }
  return lateness_ns;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string port = argc > 1 ? argv[1] : "0";
  const bool closed = port.starts_with("closed:");
  Program backend;
  wholehand::ControlHolder controls;
  wholehand::UdpBridge bridge(backend, controls);
  wholehand::ServerOptions options;
  options.port = static_cast<std::uint16_t>(std::atoi(port.c_str() + (closed ? 7 : 0)));
  if (argc > 2) options.token = argv[2];
  options.udp = &bridge;
  options.log = [](const std::string& line) { std::fprintf(stderr, "server: %s\n", line.c_str()); };
  if (!closed) {
    if (const auto started = bridge.start({{0x7F000001, 0}}); !started) {
      std::fprintf(stderr, "%s\n", wholehand::format(started.errors()).c_str());
      return 2;
    }
  }
  auto server = wholehand::Server::open(backend, options, controls);
  if (!server) {
    std::fprintf(stderr, "%s\n", wholehand::format(server.errors()).c_str());
    return 2;
  }
  std::printf("port %u\n", unsigned{(*server)->port()});
  std::fflush(stdout);

  std::atomic<bool> stopping{false};
  std::vector<std::int64_t> lateness_ns;
  std::thread telemetry([&] { lateness_ns = publish(bridge, **server, backend, stopping); });
  while (std::getchar() != EOF) {
  }
  stopping = true;
  telemetry.join();
  bridge.stop();
  std::sort(lateness_ns.begin(), lateness_ns.end());
  const auto& c = bridge.counters();
  std::printf("late p99 %.3f ms, max %.3f ms; states %llu, full %llu\n",
              static_cast<double>(lateness_ns[lateness_ns.size() * 99 / 100]) * 1e-6,
              static_cast<double>(lateness_ns.back()) * 1e-6,
              static_cast<unsigned long long>(c.states_sent),
              static_cast<unsigned long long>(c.dropped_full));
  return 0;
}
