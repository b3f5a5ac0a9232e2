#pragma once

#include "core/tick_record.hpp"
#include "server/backend.hpp"
#include "server/controls_arbiter.hpp"
#include "server/udp_counters.hpp"
#include "server/udp_datagram.hpp"
#include "server/udp_peer.hpp"
#include "server/wire.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace wholehand::udp {

/// A message from a game.
struct ReceivedCommand {
  ControlsArbiter::Client client = 0;
  wire::ClientMessage message;
};

/// The program's side of the conversation with all games: docs/udp.md. Knows no sockets, clocks or
/// threads: time is an argument, datagrams leave through a function, and the games' messages wait
/// for takeCommands(). One thread at a time.
class Host {
 public:
  using Send = std::function<UdpSent(const UdpEndpoint&, std::span<const std::uint8_t>)>;

  /// Timeout of a silent game; then nothing is sent to it.
  static constexpr std::int64_t kGone_ns = 1'000'000'000;
  /// Limit of a game's commands per second: one aim a tick and a reserve. Stops are exempt.
  static constexpr int kMostCommands = 1200;
  /// Longest interval between two datagrams of the program.
  static constexpr std::int64_t kPresent_ns = 100'000'000;

  Host(ControlsArbiter& controls, UdpCounters& counters, Send send);

  /// Assigns a key to a client.
  /// @param standalone the client has no WebSocket
  void admit(std::uint64_t key, ControlsArbiter::Client client, bool standalone);
  /// Invalidates the client's key.
  void dismiss(ControlsArbiter::Client client);

  /// Sets the scene of the states that follow.
  void setScene(std::shared_ptr<const SceneFacts> scene);
  /// Sends a record's state to every game that is due for one.
  void publish(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns);
  /// Repeats the newest record while no new ones arrive, so that games see the run state.
  void publishIdle(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns);
  /// Handles a datagram: any bytes from any sender.
  void receive(const UdpEndpoint& from, std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  /// Removes silent games and sends the keep-alives that are due. Call at least every 10 ms.
  void advance(std::int64_t now_ns);
  /// Messages since the last call, in order: emergency stops, and orders that the server judges.
  [[nodiscard]] std::vector<ReceivedCommand> takeCommands();
  /// Reports the outcome of an emergency stop that takeCommands() returned. Only a stop that was
  /// obeyed is acknowledged to the game; one that failed is handed on again when it is repeated.
  void finishStop(const ReceivedCommand& stop, bool obeyed);

  [[nodiscard]] const std::vector<Peer>& peers() const noexcept { return peers_; }

 private:
  [[nodiscard]] Peer* find(std::uint64_t key);
  void begin(Peer& peer, const UdpEndpoint& from);
  void follow(Peer& peer, const Header& header, std::int64_t now_ns);
  void obey(Peer& peer, const wire::ClientMessage& message, std::int64_t now_ns);
  void stop(Peer& peer, const wire::ClientMessage& message);
  void send(Peer& peer, Kind kind, std::span<const std::uint8_t> message, std::int64_t now_ns);
  void countGames();

  ControlsArbiter& controls_;
  UdpCounters& counters_;
  Send send_;
  std::vector<Peer> peers_;
  std::vector<ReceivedCommand> said_;
  std::shared_ptr<const SceneFacts> scene_;
  std::unique_ptr<wire::StateEncoder> encoder_;
  std::uint32_t tick_rate_hz_ = 1000;
};

}  // namespace wholehand::udp
