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

/// What a game said.
struct Said {
  ControlsArbiter::Client client = 0;
  wire::ClientMessage message;
};

/// The program's side of the conversation with all games: docs/udp.md. Pure of sockets, clocks and
/// threads: time is an argument, datagrams leave through a function, what games say waits to be
/// taken. One thread at a time.
class Host {
 public:
  using Send = std::function<UdpSent(const UdpEndpoint&, std::span<const std::uint8_t>)>;

  /// A game that is silent for longer gets nothing any more.
  static constexpr std::int64_t kGone_ns = 1'000'000'000;
  /// Commands of one game in a second: an aim at every tick, and some. Stops pass.
  static constexpr int kMostCommands = 1200;
  /// The program says so often at least that it is there.
  static constexpr std::int64_t kPresent_ns = 100'000'000;

  Host(ControlsArbiter& controls, UdpCounters& counters, Send send);

  /// Who shows the key from now on is that client.
  /// @param standalone it has no WebSocket
  void admit(std::uint64_t key, ControlsArbiter::Client client, bool standalone);
  /// Its key opens nothing any more.
  void dismiss(ControlsArbiter::Client client);

  /// What states of now on belong to.
  void setScene(std::shared_ptr<const SceneFacts> scene);
  /// A record: its state to whom it is due.
  void publish(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns);
  /// The newest record once more while none come: games see the run state.
  void publishIdle(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns);
  /// Any bytes from anybody.
  void receive(const UdpEndpoint& from, std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  /// Who is gone, and who has not heard of the program for long. Every ≤ 10 ms.
  void advance(std::int64_t now_ns);
  /// Since the last call, in order: emergency stops, and what the server judges.
  [[nodiscard]] std::vector<Said> takeSaid();

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
  std::vector<Said> said_;
  std::shared_ptr<const SceneFacts> scene_;
  std::unique_ptr<wire::StateEncoder> encoder_;
  std::uint32_t tick_rate_hz_ = 1000;
};

}  // namespace wholehand::udp
