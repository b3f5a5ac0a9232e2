#pragma once

#include "record/run/run.hpp"
#include "rig/models.hpp"
#include "rig/registry/body_registry.hpp"
#include "station/game_body_tracker.hpp"

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

namespace wholehand {

/// The bodies of a game at a station: every order to them goes through here, and what became of
/// them is published here. Orders wait for the next arming while nothing is armed; bodies beyond
/// the slots of the loop are the registry's. One thread at a time.
class StationBodies {
 public:
  /// A session begins: it gets the orders that were kept, of the client that still holds the
  /// controls. They stay kept until begun().
  /// @param claim newest claim on the controls
  /// @pre `loop` outlives the session, and its queue is empty
  void begin(const Models& models, Run& loop, std::uint32_t claim);
  /// The session runs.
  void begun() { kept_.clear(); }
  /// The session never ran: what was kept waits for the next one.
  void giveBack();
  /// The session is over: nothing stays.
  void end();
  /// Another scene is loaded: drops what was kept.
  void dropKept();

  /// Shapes and spawns for the next arming. @pre no session
  [[nodiscard]] OrderReply keep(CheckedOrders& orders, std::uint32_t claim);
  /// All commands of a message are for the loop's next ticks, or none: a set of shapes must not
  /// arrive in part. @pre a session
  [[nodiscard]] OrderReply handOver(CheckedOrders& orders);
  /// Takes a record, in order, and hands the registry's commands to the loop.
  void see(const TickRecord& record);

  /// Bodies in slots; null: none. A change makes a new object.
  [[nodiscard]] std::shared_ptr<const GameBodies> inSlots() const { return tracker_.bodies(); }
  /// Bodies of the registry, likewise.
  [[nodiscard]] std::shared_ptr<const RegisteredBodies> registered() const { return registered_; }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] OrderReply take(CheckedOrders& orders, std::size_t waiting, const char* where);
  void takeBack(CheckedOrders& orders);
  bool takeBack(const Command& removal);
  void orderRegistered(CheckedOrders& orders);
  void keepSlotsApart(CheckedOrders& orders);
  void publish();

  GameBodyTracker tracker_;
  BodyRegistry registry_;
  Run* loop_ = nullptr;              ///< of the session that takes bodies; null: none
  std::vector<CheckedOrders> kept_;  ///< shapes and spawns for the next arming
  std::uint32_t kept_claim_ = 0;     ///< of the client that ordered them
  std::shared_ptr<const RegisteredBodies> registered_;  ///< as published; null: none
  std::uint64_t published_version_ = 0, published_moves_ = 0;
  Clock::time_point published_at_;
};

}  // namespace wholehand
