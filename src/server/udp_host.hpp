#pragma once

#include "core/tick_record.hpp"
#include "server/backend.hpp"
#include "server/controls_arbiter.hpp"
#include "server/udp_counters.hpp"
#include "server/udp_peer.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace wholehand::udp {

/// Who may speak to the program.
struct Admission {
  std::vector<UdpEndpoint> peers;  ///< beside this machine; port 0: any of that host
  std::string token;               ///< every Hello must carry it; empty: none is asked
  std::size_t most_peers = 4;
};

/// An order of a game, to be carried out by the backend where no lock is held.
struct PendingOrder {
  std::uint32_t session = 0;
  std::uint32_t command = 0;  ///< 0: no answer is wanted
  Order order;
};

/// The program's side of the conversation with all games: docs/udp.md. Pure of sockets, clocks and
/// threads: time is an argument, datagrams leave through a function, orders wait to be taken.
/// One thread at a time.
class Host {
 public:
  using Send = std::function<UdpSent(const UdpEndpoint&, std::span<const std::uint8_t>)>;

  /// After which a holder of the controls that is not heard loses them.
  static constexpr std::int64_t kSilence_ns = 200'000'000;
  /// After which a game counts as gone, and the hand of a lost holder falls to the virtual patient.
  static constexpr std::int64_t kGone_ns = 5'000'000'000;
  /// After which a Hello whose address has answered nothing is forgotten.
  static constexpr std::int64_t kUnanswered_ns = 1'000'000'000;
  /// Hellos that wait for that. They take no game's place; the oldest gives way.
  static constexpr std::size_t kMostUnanswered = 16;
  /// Commands of one game in a second: an aim at every tick, and some. Stops pass.
  static constexpr int kMostCommands = 1200;
  /// The program says so often at least that it is there.
  static constexpr std::int64_t kHeartbeat_ns = 100'000'000;

  Host(Admission admission, ControlsArbiter& controls, UdpCounters& counters, Send send,
       std::uint64_t seed);

  /// What states of now on belong to; sent to all where it is another than before.
  void setScene(std::shared_ptr<const SceneFacts> scene, std::int64_t now_ns);
  /// A record: its state to whom it is due, its events to all.
  void publish(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns);
  /// The newest record once more while none come: games see the run state.
  void publishIdle(const TickRecord& record, const LoopStatus& status, std::int64_t now_ns);
  /// Any bytes from anybody.
  void receive(const UdpEndpoint& from, std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  /// What is due: repetitions, heartbeats, silence, who holds the controls. Every ≤ 10 ms.
  void advance(std::int64_t now_ns);
  /// The answer to an order; nobody gets it where the conversation is over.
  void answer(const PendingOrder& pending, const OrderReply& given, std::int64_t now_ns);
  /// Orders since the last call, in order.
  [[nodiscard]] std::vector<PendingOrder> takeOrders();
  /// Tells all games that the program ends.
  void sayGoodbye(std::int64_t now_ns);

  [[nodiscard]] const std::vector<Peer>& peers() const noexcept { return peers_; }

 private:
  [[nodiscard]] Peer* find(const UdpEndpoint& endpoint);
  [[nodiscard]] bool mayHello(const UdpEndpoint& from) const;
  void receiveHello(const UdpEndpoint& from, std::span<const std::uint8_t> payload,
                    std::int64_t now_ns);
  void refuseHello(const UdpEndpoint& to, UdpIgnored reason, const std::string& why,
                   std::int64_t now_ns);
  void welcome(Peer& peer, std::int64_t now_ns);
  void receiveFrom(Peer& peer, const Received& datagram, std::int64_t now_ns);
  void makeRoomForHello(const UdpEndpoint& from, std::int64_t now_ns);
  [[nodiscard]] bool begin(Peer& peer, std::int64_t now_ns);
  void refuseFull(const UdpEndpoint& to, std::int64_t now_ns);
  [[nodiscard]] std::size_t games() const;
  void receiveMessage(Peer& peer, std::span<const std::uint8_t> message, std::int64_t now_ns);
  void receiveCommand(Peer& peer, const wire::ClientMessage& message, std::int64_t now_ns);
  void receiveOrder(Peer& peer, const wire::ClientMessage& message, std::int64_t now_ns);
  void takeControls(Peer& peer, std::uint32_t command, std::int64_t now_ns);
  void releaseControls(Peer& peer, std::uint32_t command, std::int64_t now_ns);
  void reply(Peer& peer, std::uint32_t command, const OrderReply& given, std::int64_t now_ns);
  void tellControls(Peer& peer, std::int64_t now_ns);
  [[nodiscard]] bool tooMany(Peer& peer, std::int64_t now_ns);
  void refuseForRate(Peer& peer, const wire::ClientMessage& message, std::int64_t now_ns);
  void watchHolder(Peer& peer, std::int64_t now_ns);
  void giveBack(std::uint32_t claim);
  void leave(Peer& peer, std::int64_t now_ns);
  /// How many.
  std::size_t remove(const std::function<bool(const Peer&)>& which, std::int64_t now_ns);
  void order(OrderType type, double value, std::uint32_t claim);

  void sendReliable(Peer& peer, ReliableOutbox::Message message, std::int64_t now_ns);
  void sendDue(Peer& peer, std::int64_t now_ns);
  void sendState(Peer& peer, std::span<const std::uint8_t> message, std::int64_t now_ns);
  void sendOnce(Peer& peer, Kind kind, std::span<const std::uint8_t> message, std::int64_t now_ns);
  void sendTo(const UdpEndpoint& to, const Header& header, std::span<const std::uint8_t> message);

  Admission admission_;
  ControlsArbiter& controls_;
  UdpCounters& counters_;
  Send send_;
  std::uint64_t random_;
  std::vector<std::uint64_t> old_nonces_;  ///< of games: a replayed Hello must not begin anew
  std::vector<Peer> peers_;
  std::vector<PendingOrder> orders_;
  std::optional<std::int64_t> lost_ns_;  ///< when a holder vanished; nobody took over
  std::uint32_t lost_claim_ = 0;         ///< of that holder
  std::shared_ptr<const SceneFacts> scene_;
  ReliableOutbox::Message scene_message_;
  std::unique_ptr<wire::StateEncoder> encoder_;
  std::uint32_t tick_rate_hz_ = 1000;
};

}  // namespace wholehand::udp
