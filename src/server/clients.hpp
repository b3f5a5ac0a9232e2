#pragma once

#include "server/access.hpp"
#include "server/backend.hpp"
#include "server/control_desk.hpp"
#include "server/event_mailbox.hpp"
#include "server/rate_limited_log.hpp"
#include "server/roles.hpp"
#include "server/traffic.hpp"
#include "server/udp_bridge.hpp"
#include "server/wire.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace wholehand {

using SharedBytes = std::shared_ptr<const wire::Bytes>;

/// A connected client, as a line to write to. No call blocks or calls back.
class ClientLine {
 public:
  virtual ~ClientLine() = default;

  /// Must arrive, in order: waits while earlier ones are written.
  virtual void deliver(SharedBytes message) = 0;
  /// Worth something only when it is new: false where earlier writing goes on.
  [[nodiscard]] virtual bool offer(SharedBytes state, std::int64_t arrived_ns) = 0;
  /// Messages that wait beside the one being written.
  [[nodiscard]] virtual std::size_t waiting() const = 0;
  /// Since when the one being written is; 0: nothing is.
  [[nodiscard]] virtual std::int64_t writingSince_ns() const = 0;
  /// Of the other end, without its port.
  [[nodiscard]] virtual std::string address() const = 0;
  /// Ends the connection at once.
  virtual void cut() = 0;
};

/// All WebSocket clients: what they are told, and what they may order. Knows no sockets; one
/// thread, time is an argument.
class Clients : public std::enable_shared_from_this<Clients> {
 public:
  static constexpr std::int64_t kDrainWithin_ns = 2'000'000'000;
  static constexpr std::size_t kMostWaiting = 64;
  static constexpr double kMessagesPerSecond = 400.0;

  /// Runs a task on the server's thread; called from any thread.
  using Post = std::function<void(std::function<void()>)>;

  /// What a program that leads through a commissioning says of it; empty: it does not.
  using Commissioning = std::function<std::shared_ptr<const CommissioningFacts>()>;

  Clients(ServerBackend& backend, EventMailbox& mailbox, Traffic& traffic, RateLimitedLog& log,
          ControlsArbiter& controls, Access access, Post post, Commissioning commissioning = {},
          UdpBridge* udp = nullptr);

  /// Greets a new client; its number.
  std::uint32_t join(std::shared_ptr<ClientLine> line, Role role, std::int64_t now_ns);
  /// A game that speaks by datagrams alone, where one is awaited: it is there for good.
  void joinStandalone();
  /// Its connection ended.
  void leave(std::uint32_t client, std::int64_t now_ns);
  /// Cuts a client off where all places are taken, so that nobody is shut out for good: of the
  /// address that has most of them, the newcomer counted, the one that came first. Never who holds
  /// the controls. False where there is nobody else.
  [[nodiscard]] bool makeRoom(const std::string& newcomer, std::int64_t now_ns);
  /// It said something.
  void heard(std::uint32_t client, std::span<const std::uint8_t> message, bool text,
             std::int64_t now_ns);
  /// It said something by datagram, whose key and order were found right.
  void heardDatagram(std::uint32_t client, const wire::ClientMessage& message, std::int64_t now_ns);
  /// It said more than kLargestClientMessage; its connection is being closed.
  void saidTooMuch(std::uint32_t client, std::int64_t now_ns);
  /// 60 times a second: scene, events, state, controls, clients that do not follow.
  void tick(std::int64_t now_ns);

  [[nodiscard]] std::size_t count() const { return clients_.size() - (standalone_ != 0 ? 1 : 0); }

 private:
  struct Client {
    std::shared_ptr<ClientLine> line;
    Role role = Role::kUnsaid;
    std::uint32_t last_command = 0;
    double allowance = kMessagesPerSecond;  ///< messages it may send now
    std::int64_t allowance_ns = 0;          ///< when that was so
    std::int64_t last_rate_reply_ns = 0;
    std::uint64_t state = 0;   ///< number of the newest state it has
    bool aim_refused = false;  ///< by datagram; it is told once, until one is accepted
  };
  using Entry = std::map<std::uint32_t, Client>::iterator;

  /// @param counter of wholehand_refused_total
  void refuse(Entry client, std::uint32_t command, const char* counter, const OrderReply& refusal,
              std::int64_t now_ns, bool reply = true);
  [[nodiscard]] bool withinRate(Entry entry, std::int64_t now_ns);
  void refuseForRate(Entry entry, const wire::ClientMessage* message, std::int64_t now_ns);
  void obey(Entry entry, const wire::ClientMessage& message, std::int64_t now_ns);
  [[nodiscard]] Standing standingOf(std::uint32_t client, const Order& order) const;
  void obeyOrder(Entry entry, const wire::ClientMessage& message, std::int64_t now_ns);
  void changeHands(Entry entry, const wire::ClientMessage& message, std::int64_t now_ns);
  void noteOrder(Entry entry, const Order& order, std::int64_t now_ns);
  [[nodiscard]] std::string takeControls(Entry entry, std::int64_t now_ns);
  [[nodiscard]] bool led() const;
  [[nodiscard]] Role roleOf(std::uint32_t client) const;
  void forward(std::uint32_t client, std::uint32_t command, Order order);
  void answer(std::uint32_t client, std::uint32_t command, const OrderReply& reply);
  void aim(Entry entry, const wire::ClientMessage& message, std::int64_t now_ns);
  void aimed(std::uint32_t client, std::uint32_t command, const OrderReply& reply);
  void orderQuietly(const Order& order);
  void followControls(std::int64_t now_ns);
  void tellControls();
  [[nodiscard]] SharedBytes controlsFor(std::uint32_t client, Role role) const;
  void followEndings(const LoopStatus& status, std::int64_t now_ns);
  void deliverToAll(const SharedBytes& message);
  void followScene();
  void followCommissioning(std::int64_t now_ns);
  void sendEvents();
  void sendState(std::int64_t now_ns);
  void dropSlow(std::int64_t now_ns);

  ServerBackend& backend_;
  EventMailbox& mailbox_;
  Traffic& traffic_;
  RateLimitedLog& log_;
  Access access_;
  Post post_;

  UdpBridge* udp_;
  std::uint32_t standalone_ = 0;  ///< the client that has no WebSocket; 0: there is none

  std::map<std::uint32_t, Client> clients_;
  ControlsArbiter& controls_;
  ControlDesk desk_;
  std::uint32_t resting_ = 0;      ///< the player who asked for the newest rest; 0: nobody
  bool therapist_paused_ = false;  ///< the exercise, and has not let it go on
  std::uint32_t endings_ = 0;      ///< of the program, as last looked at; 0: not yet

  Commissioning commissioning_;
  std::shared_ptr<const CommissioningFacts> commissioning_shown_;
  SharedBytes commissioning_message_;
  std::int64_t commissioning_ns_ = 0;  ///< when it was last sent

  std::shared_ptr<const SceneFacts> scene_;
  SharedBytes scene_message_;
  std::unique_ptr<wire::StateEncoder> encoder_;
  std::vector<wire::NumberedEvent> events_;
  std::unique_ptr<TickRecord> record_;
  LoopStatus shown_;  ///< status of the newest state
  std::uint64_t shown_tick_ = 0;
  std::int64_t shown_ns_ = 0;  ///< when it was made
  std::uint64_t state_number_ = 0;
  SharedBytes state_;
  std::int64_t state_arrived_ns_ = 0;
};

}  // namespace wholehand
