#pragma once

#include "core/expected.hpp"
#include "core/tick_record.hpp"
#include "server/backend.hpp"
#include "server/controls_arbiter.hpp"
#include "server/udp_counters.hpp"
#include "server/udp_socket.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// How games are spoken to.
struct UdpOptions {
  UdpEndpoint local{0x7F000001, kDefaultPort};  ///< 127.0.0.1; port 0: the system chooses
  std::vector<UdpEndpoint> peers;  ///< games on other machines; port 0: any of that host
  std::string token;               ///< every Hello must carry it; empty: none is asked
  std::size_t most_peers = 4;

  static constexpr std::uint16_t kDefaultPort = 8091;
};

/// Sends hand coordinates to games at their rates, scenes and events until they are acknowledged,
/// and hears their commands: docs/udp.md. It has a thread of its own for what it receives;
/// publish() sends from its caller's. Neither waits, and neither touches the loop.
class UdpBridge {
 public:
  /// Both must outlive the bridge.
  UdpBridge(ServerBackend& backend, ControlsArbiter& controls);
  ~UdpBridge() { stop(); }
  UdpBridge(const UdpBridge&) = delete;
  UdpBridge& operator=(const UdpBridge&) = delete;

  /// Binds and starts to listen; to be called once. Fails for an address that cannot be bound,
  /// games elsewhere while bound to loopback, and an address others can reach without a token of 8
  /// characters.
  [[nodiscard]] Expected<Done> start(const UdpOptions& options);
  /// Says goodbye to all games and ends the thread. Idempotent.
  void stop();

  /// Every record of the loop, in order; one thread at a time (telemetry's). Never waits for the
  /// network: what does not fit into the socket is dropped and counted.
  void publish(const TickRecord& record);

  [[nodiscard]] const UdpCounters& counters() const noexcept { return counters_; }
  /// Where it listens. @pre start() succeeded
  [[nodiscard]] UdpEndpoint local() const noexcept;

 private:
  struct Core;

  ServerBackend& backend_;
  ControlsArbiter& controls_;
  UdpCounters counters_;
  std::shared_ptr<Core> core_;  ///< answers of the backend may come after stop()
};

}  // namespace wholehand
