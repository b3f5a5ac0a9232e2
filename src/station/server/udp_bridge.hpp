#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/tick_record.hpp"
#include "station/server/control_holder.hpp"
#include "station/server/traffic.hpp"
#include "station/server/udp_socket.hpp"
#include "vocabulary/backend.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace wholehand {

/// Options of the UDP side.
struct UdpOptions {
  UdpEndpoint local{0x7F000001, kDefaultPort};  ///< 127.0.0.1; port 0: the system chooses
  std::uint64_t key = 0;                        ///< key of a game without a WebSocket; 0: none is
                                                ///< expected

  static constexpr std::uint16_t kDefaultPort = 8091;
};

/// Reads the key of --udp-key: 16 hexadecimal digits, not all of them 0.
[[nodiscard]] Expected<std::uint64_t> parseUdpKey(const std::string& text);

/// Exchanges data of which only the newest matters with games: sends states, and receives aims and
/// emergency stops (docs/udp.md). Everything else goes over the server's WebSocket. It receives on
/// its own thread; publish() sends from its caller's. Neither waits, and neither touches the loop.
class UdpBridge {
 public:
  using Client = ControlHolder::Client;
  /// Takes a client's messages, except emergency stops; called on the bridge's thread.
  using Listener = std::function<void(Client, const Order&)>;

  /// @pre backend and controls outlive the bridge
  UdpBridge(ServerBackend& backend, ControlHolder& controls);
  ~UdpBridge();
  UdpBridge(const UdpBridge&) = delete;
  UdpBridge& operator=(const UdpBridge&) = delete;

  /// Binds the socket and starts to receive. Call once, before a server uses the bridge. Fails when
  /// the address cannot be bound.
  [[nodiscard]] Expected<Done> start(const UdpOptions& options);
  /// Ends the thread. Idempotent.
  void stop();

  /// Sends a record to the games. Call for every record, in order, from one thread at a time
  /// (telemetry's). Never waits for the network: datagrams that do not fit into the socket buffer
  /// are dropped and counted.
  void publish(const TickRecord& record);

  /// Port and key for a client's datagrams; port 0: no datagrams.
  struct DatagramAccess {
    std::uint16_t port = 0;
    std::uint64_t key = 0;
  };
  /// Makes a new key for a client. Any thread, also for the functions below.
  [[nodiscard]] DatagramAccess admit(Client client);
  /// True when a game without a WebSocket is expected.
  [[nodiscard]] bool awaitsStandalone() const noexcept;
  /// Registers the game without a WebSocket as a client.
  void admitStandalone(Client client);
  /// Invalidates a client's key after its connection ended.
  void dismiss(Client client);
  /// Sets the listener; empty: none.
  void setListener(Listener listener);

  [[nodiscard]] const UdpCounters& counters() const noexcept { return counters_; }
  /// Bound address. @pre start() succeeded
  [[nodiscard]] UdpEndpoint local() const noexcept;

 private:
  struct Core;

  ServerBackend& backend_;
  ControlHolder& controls_;
  UdpCounters counters_;
  std::unique_ptr<Core> core_;
};

}  // namespace wholehand
