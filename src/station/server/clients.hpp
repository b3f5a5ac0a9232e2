#pragma once

#include "loop/core/active_time.hpp"
#include "loop/core/tick_record.hpp"
#include "station/server/access.hpp"
#include "station/server/control_timeouts.hpp"
#include "station/server/logs.hpp"
#include "station/server/traffic.hpp"
#include "station/server/udp_bridge.hpp"
#include "station/server/wire.hpp"
#include "vocabulary/backend.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace wholehand {

/// Carries the events of every record, the arrival times of the newest records and the person's
/// active time from the telemetry thread to the server's. Bounded: when it is full, events are
/// dropped and counted.
class EventMailbox {
 public:
  static constexpr std::size_t kCapacity = 4096;  ///< most events that wait

  EventMailbox() { waiting_.reserve(kCapacity); }

  /// Adds a record's events. Telemetry thread; does not allocate.
  void put(const TickRecord& record, std::int64_t now_ns);
  /// Names what the records hold from now on; other names begin the active time anew.
  void describe(std::vector<std::string> axis_units, std::vector<std::string> value_names);
  /// Active time of the session of the newest record.
  [[nodiscard]] ActivePeriods active() const;
  /// Moves all waiting events into `events`, which is emptied first.
  void fetch(std::vector<wire::NumberedEvent>& events);

  /// Arrival time of the record of a tick; of the newest record when that time is no longer known.
  [[nodiscard]] std::int64_t arrivalOf(std::uint64_t tick) const;
  /// Arrival time of the newest record; 0: none yet.
  [[nodiscard]] std::int64_t newest_ns() const;
  [[nodiscard]] std::uint64_t dropped() const;

 private:
  struct Arrival {
    std::uint64_t tick = ~std::uint64_t{0};
    std::int64_t at_ns = 0;
  };

  mutable std::mutex mutex_;
  std::vector<wire::NumberedEvent> waiting_;
  std::array<Arrival, 256> arrivals_{};  ///< at tick mod 256
  std::int64_t newest_ns_ = 0;
  std::uint64_t dropped_ = 0;
  std::vector<std::string> axis_units_, value_names_;
  ActiveTime not_active_{{}, {}}, active_ = not_active_;  ///< before its first tick, and now
  std::uint64_t newest_tick_ = 0;
};

using SharedBytes = std::shared_ptr<const wire::Bytes>;

/// The outgoing side of a client's connection. No call blocks or calls back.
class ClientConnection {
 public:
  virtual ~ClientConnection() = default;

  /// Sends a message reliably and in order; it is queued while earlier ones are written.
  virtual void deliver(SharedBytes message) = 0;
  /// Sends a state if the line is idle. Returns false while an earlier message is being written.
  [[nodiscard]] virtual bool offer(SharedBytes state, std::int64_t arrived_ns) = 0;
  /// Number of queued messages, without the one being written.
  [[nodiscard]] virtual std::size_t waiting() const = 0;
  /// Time at which the current write began; 0: no write under way.
  [[nodiscard]] virtual std::int64_t writingSince_ns() const = 0;
  /// Address of the peer, without its port.
  [[nodiscard]] virtual std::string address() const = 0;
  /// Ends the connection once what waits has been written, and tells the client why.
  virtual void close(const std::string& reason) = 0;
  /// Ends the connection at once.
  virtual void cut() = 0;
};

/// All WebSocket clients: sends them states and replies, and judges their orders. Knows no sockets.
/// One thread; time is an argument.
class Clients : public std::enable_shared_from_this<Clients> {
 public:
  static constexpr std::int64_t kDrainWithin_ns = 2'000'000'000;
  static constexpr std::size_t kMostWaiting = 64;
  static constexpr double kMessagesPerSecond = 400.0;
  /// A larger message counts as several for the rate limit: one for each part of this size [bytes].
  static constexpr std::size_t kMessageSize = 4096;

  /// Runs a task on the server's thread; called from any thread.
  using Post = std::function<void(std::function<void()>)>;

  /// Returns the facts of a commissioning; empty: the program runs none.
  using Commissioning = std::function<std::shared_ptr<const CommissioningFacts>()>;

  Clients(ServerBackend& backend, EventMailbox& mailbox, Traffic& traffic, RateLimitedLog& log,
          ControlHolder& controls, Access access, Post post, Commissioning commissioning = {},
          UdpBridge* udp = nullptr);

  /// Greets a new client; returns its number.
  std::uint32_t join(std::shared_ptr<ClientConnection> connection, Role role, std::int64_t now_ns);
  /// Adds the game that uses datagrams only, if one is expected. It never leaves.
  void joinStandalone();
  /// Removes a client after its connection ended.
  void leave(std::uint32_t client, std::int64_t now_ns);
  /// Disconnects a client when all places are taken, so that nobody is locked out for good. It
  /// takes the oldest client of the address that has the most connections, the newcomer's included,
  /// and never the holder of the controls. False when there is no other client.
  [[nodiscard]] bool makeRoom(const std::string& newcomer, std::int64_t now_ns);
  /// Handles a WebSocket message.
  void receive(std::uint32_t client, std::span<const std::uint8_t> message, bool text,
               std::int64_t now_ns);
  /// Handles a datagram whose key and sequence number were verified.
  void receiveDatagram(std::uint32_t client, const Order& order, std::int64_t now_ns);
  /// Refuses a message larger than kLargestClientMessage; its connection is being closed.
  void refuseOversized(std::uint32_t client, std::int64_t now_ns);
  /// Called 60 times a second: sends scene, events, state and controls, and disconnects clients
  /// that do not keep up.
  void tick(std::int64_t now_ns);

  [[nodiscard]] std::size_t count() const { return clients_.size() - (standalone_ != 0 ? 1 : 0); }

 private:
  struct Client {
    std::shared_ptr<ClientConnection> connection;
    std::shared_ptr<Requester> requester = std::make_shared<Requester>();
    Role role = Role::kUnspecified;
    std::uint32_t last_command = 0;
    double allowance = kMessagesPerSecond;  ///< messages it may send now (token bucket)
    std::int64_t allowance_ns = 0;          ///< time of `allowance`
    std::int64_t last_rate_reply_ns = 0;
    std::uint64_t state = 0;   ///< number of the newest state sent to it
    bool closing = false;      ///< the connection is being closed after an unreadable message
    bool aim_refused = false;  ///< an aim by datagram was refused; the refusal is reported once,
                               ///< until an aim is accepted
  };
  using Entry = std::map<std::uint32_t, Client>::iterator;

  /// Refuses an order.
  /// @param counter label of wholehand_refused_total
  void refuse(Entry client, std::uint32_t command, const char* counter, const OrderReply& refusal,
              std::int64_t now_ns, bool reply = true);
  [[nodiscard]] bool withinRate(Entry entry, std::size_t bytes, std::int64_t now_ns);
  void refuseForRate(Entry entry, const Order* message, std::int64_t now_ns);
  void refuseUnread(Entry entry, std::uint32_t command, const char* counter,
                    const OrderReply& refusal, std::int64_t now_ns);
  void apply(Entry entry, const Order& order, std::int64_t now_ns);
  [[nodiscard]] Standing standingOf(std::uint32_t client, const Order& order,
                                    const LoopStatus& status) const;
  void applyOrder(Entry entry, Order order, std::int64_t now_ns);
  void changeHands(Entry entry, const Order& order, std::int64_t now_ns);
  void noteOrder(Entry entry, const Order& order, const LoopStatus& status, std::int64_t now_ns);
  [[nodiscard]] std::string takeControls(Entry entry, std::int64_t now_ns);
  [[nodiscard]] bool led() const;
  [[nodiscard]] Role roleOf(std::uint32_t client) const;
  void forward(Entry entry, Order order);
  void answer(std::uint32_t client, std::uint32_t command, const OrderReply& reply);
  void aim(Entry entry, Order order, std::int64_t now_ns);
  void aimed(std::uint32_t client, std::uint32_t command, const OrderReply& reply);
  void orderQuietly(orders::Any what, std::uint32_t claim = 0);
  void followControls(std::int64_t now_ns);
  void sendControls();
  [[nodiscard]] SharedBytes controlsFor(std::uint32_t client, Role role) const;
  void followEndings(const LoopStatus& status, std::int64_t now_ns);
  void deliverToAll(const SharedBytes& message);
  void followScene();
  void followCommissioning(std::int64_t now_ns);
  void followBodies(const LoopStatus& status);
  [[nodiscard]] SharedBytes bodiesMessage() const;
  [[nodiscard]] bool showsBodies() const {
    return (bodies_shown_ && !bodies_shown_->empty()) ||
           (registered_shown_ && !registered_shown_->empty());
  }
  void sendEvents();
  void sendState(LoopStatus status, std::int64_t now_ns);
  void dropSlow(std::int64_t now_ns);

  ServerBackend& backend_;
  EventMailbox& mailbox_;
  Traffic& traffic_;
  RateLimitedLog& log_;
  Access access_;
  Post post_;

  UdpBridge* udp_;
  std::uint32_t standalone_ = 0;  ///< client without a WebSocket; 0: none

  std::map<std::uint32_t, Client> clients_;
  ControlHolder& controls_;
  ControlTimeouts timeouts_;
  std::uint32_t resting_ = 0;               ///< client who began the newest rest; 0: none
  std::optional<std::uint32_t> paused_in_;  ///< session that a therapist paused and did not resume
  std::uint32_t endings_ = 0;               ///< endings in the last status; 0: no status read yet

  Commissioning commissioning_;
  std::shared_ptr<const CommissioningFacts> commissioning_shown_;
  SharedBytes commissioning_message_;
  std::int64_t commissioning_ns_ = 0;  ///< time of the last commissioning message

  std::shared_ptr<const GameBodies> bodies_shown_;  ///< as reported to clients; null: none
  std::shared_ptr<const RegisteredBodies> registered_shown_;  ///< as last reported to clients;
                                                              ///< null: none
  std::uint32_t bodies_session_ = 0;                          ///< session of the reported bodies

  std::shared_ptr<const SceneFacts> scene_;
  SharedBytes scene_message_;
  std::unique_ptr<wire::StateEncoder> encoder_;
  std::vector<wire::NumberedEvent> events_;
  std::unique_ptr<TickRecord> record_;
  LoopStatus shown_;            ///< status of the newest state
  std::int64_t ticked_ns_ = 0;  ///< time of the last tick
  std::uint64_t shown_tick_ = 0;
  std::int64_t shown_ns_ = 0;  ///< time at which that state was made
  std::uint64_t state_number_ = 0;
  SharedBytes state_;
  std::int64_t state_arrived_ns_ = 0;
};

}  // namespace wholehand
