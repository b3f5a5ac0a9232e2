#pragma once

#include "core/expected.hpp"
#include "core/tick_record.hpp"
#include "server/backend.hpp"
#include "server/commissioning_facts.hpp"
#include "server/controls_arbiter.hpp"
#include "server/replay_service.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

class UdpBridge;

/// How the program shows itself. Safe as it stands: this machine only.
struct ServerOptions {
  std::string address = "127.0.0.1";  ///< IP address to listen at, or "localhost"
  std::uint16_t port = 8080;          ///< 0: any that is free
  std::string web_folder;             ///< with index.html; where it is missing a page says so
  /// Whoever wants more than the bare pages shows it. Empty: none is asked for; not allowed
  /// where the address is not of this machine.
  std::string token;                         ///< the therapist's; opens every role
  std::string player_token, watcher_token;   ///< each opens its role and no more; empty: none
  std::vector<std::string> allowed_origins;  ///< besides our own, e.g. "https://clinic.example"
  int max_clients = 16;                      ///< WebSocket connections at a time, 1 .. 1000
  /// For so long a request waits for a disk, or for a report to be made; then it is refused (503).
  std::chrono::milliseconds disk_patience{10'000}, report_patience{150'000};
  /// Prometheus text that follows our own at /metrics: what else the program counts. Any thread.
  std::function<std::string()> more_metrics;
  /// Carries states and aims of clients that want them faster; null: nothing does. Started before
  /// the server, and outlives it.
  UdpBridge* udp = nullptr;
  /// What is said of a device's commissioning, where the program leads through one. Any thread.
  std::function<std::shared_ptr<const CommissioningFacts>()> commissioning;
  /// Answers what a page asks of a recording that it looks at again; empty: nobody does. From
  /// threads of its own, which wait for it.
  ReplayService replay;
  /// One line for a person, from the server's thread; rate-limited.
  std::function<void(const std::string&)> log;
};

/// The shortest token [characters].
inline constexpr std::size_t kShortestToken = 16;

/// Every fault of the options.
[[nodiscard]] Diagnostics validate(const ServerOptions& options);

/// Pages, state and orders over one port: HTTP, and WebSocket at /ws. docs/protocol.md.
///
/// One thread does all input and output with clients and touches no file, so that a stop never
/// waits for a disk; others read pages, recordings and reports. The loop is read through the
/// backend and through publish(); nothing here ever makes it wait, and nothing that happens here
/// ends the process.
class Server {
 public:
  /// Listens and starts the threads; the faults of the options, or why the port cannot be had.
  /// @pre the backend and the arbiter outlive the server
  [[nodiscard]] static Expected<std::unique_ptr<Server>> open(ServerBackend& backend,
                                                              ServerOptions options,
                                                              ControlsArbiter& controls);
  /// Closes every connection, ends the threads; waits for a file that is being read, and for a
  /// report under way.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] std::uint16_t port() const noexcept;
  /// Of the game, for a person at this machine to open: "http://127.0.0.1:8080/", where the server
  /// listens to every address, too.
  [[nodiscard]] std::string url() const;
  /// Takes a record's events and notes when it came. From the telemetry thread, with every record:
  /// bounded, never waits for a client.
  void publish(const TickRecord& record);

 private:
  class Machinery;
  explicit Server(std::shared_ptr<Machinery> machinery);

  std::shared_ptr<Machinery> machinery_;  ///< answers that come late find it, or find it gone
};

}  // namespace wholehand
