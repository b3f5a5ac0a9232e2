#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/tick_record.hpp"
#include "station/server/control_holder.hpp"
#include "vocabulary/backend.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

class UdpBridge;

/// Options of the server. The defaults are safe: only this machine can connect.
struct ServerOptions {
  std::string address = "127.0.0.1";  ///< IP address to listen on, or "localhost"
  std::uint16_t port = 8080;          ///< 0: any free port
  std::string web_folder;             ///< holds index.html; without it, a page explains how to
                                      ///< build one
  /// Access tokens. Every request requires one, except for the bare pages. An empty token means
  /// open access, which is refused unless the address is a loopback one.
  std::string token;                         ///< the therapist's; opens every role
  std::string player_token, watcher_token;   ///< each opens one role only; empty: none
  std::vector<std::string> allowed_origins;  ///< in addition to the server's own, e.g.
                                             ///< "https://clinic.example"
  int max_clients = 16;                      ///< limit of simultaneous WebSocket connections, 1 ..
                                             ///< 1000
  /// Timeouts of a request that waits for a disk or for a report; afterwards it is refused (503).
  std::chrono::milliseconds disk_patience{10'000}, report_patience{150'000};
  /// More Prometheus text for /metrics, appended to the server's. Any thread.
  std::function<std::string()> more_metrics;
  /// Carries states and aims over UDP for clients that want higher rates; may be null. Started
  /// before the server, and outlives it.
  UdpBridge* udp = nullptr;
  /// Returns the state of a commissioning; empty function: the program runs none. Any thread.
  std::function<std::shared_ptr<const CommissioningFacts>()> commissioning;
  /// Port of the clinic's records; empty function: no clinic. Any thread.
  std::function<std::uint16_t()> clinic_port;
  /// Answers requests of replay pages; empty: no replay. Called on worker threads, which wait for
  /// it.
  ReplayService replay;
  /// Writes one line for a person, from the server's thread; rate-limited.
  std::function<void(const std::string&)> log;
};

/// Minimum length of a token [characters].
inline constexpr std::size_t kShortestToken = 16;

/// Returns every fault of the options.
[[nodiscard]] Diagnostics validate(const ServerOptions& options);

/// Serves pages, state and orders over one port: HTTP, and WebSocket at /ws. docs/protocol.md.
///
/// One thread does all input and output with clients and touches no file, so a stop never waits for
/// a disk. Other threads read pages, recordings and reports. The server reads the loop through the
/// backend and publish(); it never makes the loop wait, and no failure here ends the process.
class Server {
 public:
  /// Listens and starts the threads. Returns the faults of the options, or why the port cannot be
  /// opened.
  /// @pre the backend and the holder object outlive the server
  [[nodiscard]] static Expected<std::unique_ptr<Server>> open(ServerBackend& backend,
                                                              ServerOptions options,
                                                              ControlHolder& controls);
  /// Closes every connection and ends the threads. Waits for a file read or a report under way.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] std::uint16_t port() const noexcept;
  /// URL of the game for a browser on this machine ("http://127.0.0.1:8080/"), even when the server
  /// listens on every address.
  [[nodiscard]] std::string url() const;
  /// Takes a record's events and its arrival time. Telemetry thread, for every record; bounded,
  /// never waits for a client.
  void publish(const TickRecord& record);

 private:
  class Machinery;
  explicit Server(std::shared_ptr<Machinery> machinery);

  std::shared_ptr<Machinery> machinery_;  ///< late answers hold a weak pointer to it
};

}  // namespace wholehand
