#pragma once

#include "core/expected.hpp"
#include "core/tick_record.hpp"
#include "server/backend.hpp"
#include "server/controls_arbiter.hpp"
#include "server/udp_counters.hpp"
#include "server/udp_socket.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace wholehand {

namespace wire {
struct ClientMessage;
}

/// How games are spoken to.
struct UdpOptions {
  UdpEndpoint local{0x7F000001, kDefaultPort};  ///< 127.0.0.1; port 0: the system chooses
  std::uint64_t key = 0;  ///< of a game that has no WebSocket; 0: there is none

  static constexpr std::uint16_t kDefaultPort = 8091;
};

/// Reads a key as it stands behind --udp-key: 16 hexadecimal digits, not all of them 0.
[[nodiscard]] Expected<std::uint64_t> parseUdpKey(const std::string& text);

/// What only the newest of counts, between the program and games: states to them, aims from them,
/// and emergency stops (docs/udp.md). All else goes by WebSocket, through the server. It has a
/// thread of its own for what it receives; publish() sends from its caller's. Neither waits, and
/// neither touches the loop.
class UdpBridge {
 public:
  using Client = ControlsArbiter::Client;
  /// Takes what a client said, but emergency stops; called from the bridge's thread.
  using Listener = std::function<void(Client, const wire::ClientMessage&)>;

  /// Both must outlive the bridge.
  UdpBridge(ServerBackend& backend, ControlsArbiter& controls);
  ~UdpBridge();
  UdpBridge(const UdpBridge&) = delete;
  UdpBridge& operator=(const UdpBridge&) = delete;

  /// Binds and starts to listen; to be called once, before a server that uses it. Fails for an
  /// address that cannot be bound.
  [[nodiscard]] Expected<Done> start(const UdpOptions& options);
  /// Ends the thread. Idempotent.
  void stop();

  /// Every record of the loop, in order; one thread at a time (telemetry's). Never waits for the
  /// network: what does not fit into the socket is dropped and counted.
  void publish(const TickRecord& record);

  /// Where a client sends its datagrams, and what opens them; port 0: nowhere.
  struct Door {
    std::uint16_t port = 0;
    std::uint64_t key = 0;
  };
  /// A new key for that client. Any thread, as the following.
  [[nodiscard]] Door admit(Client client);
  /// Whether a game without a WebSocket may come.
  [[nodiscard]] bool awaitsStandalone() const noexcept;
  /// It is that client from now on.
  void admitStandalone(Client client);
  /// The client's connection ended, and with it its datagrams.
  void dismiss(Client client);
  /// Empty: nobody listens any more.
  void setListener(Listener listener);

  [[nodiscard]] const UdpCounters& counters() const noexcept { return counters_; }
  /// Where it listens. @pre start() succeeded
  [[nodiscard]] UdpEndpoint local() const noexcept;

 private:
  struct Core;

  ServerBackend& backend_;
  ControlsArbiter& controls_;
  UdpCounters counters_;
  std::unique_ptr<Core> core_;
};

}  // namespace wholehand
