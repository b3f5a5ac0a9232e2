#pragma once

#include "rig/models.hpp"
#include "rig/registry/body_table.hpp"
#include "rig/run/run.hpp"
#include "station/body_orders.hpp"

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

namespace wholehand {

/// Messages of a game to its bodies: hands them to the table of bodies and to the loop, and answers
/// them. While nothing is armed, orders wait for the next arming. One thread at a time.
class StationBodies {
 public:
  /// Begins a session and hands it the kept orders of the client that still holds the controls. The
  /// orders stay kept until begun().
  /// @param claim newest claim on the controls
  /// @pre `loop` outlives the session, and its queue is empty
  void begin(const Models& models, Run& loop, std::uint32_t claim);
  /// Confirms that the session runs; drops the kept orders.
  void begun() { kept_.clear(); }
  /// Reports that the session failed to start; the kept orders wait for the next one.
  void giveBack();
  /// Ends the session and forgets all bodies.
  void end();
  /// Drops the kept orders when another scene is loaded.
  void dropKept();

  /// Keeps shapes and spawns for the next arming. @pre no session runs
  [[nodiscard]] OrderReply keep(CheckedOrders& orders, std::uint32_t claim);
  /// Hands the commands of a message to the loop for its next ticks: all of them or none, because a
  /// set of shapes must not arrive in part. @pre a session runs
  [[nodiscard]] OrderReply handOver(CheckedOrders& orders);
  /// Receives the loop's records in order, and hands the table's commands to the loop.
  void onRecord(const TickRecord& record);

  /// Bodies in slots; null: none. Every change makes a new object.
  [[nodiscard]] std::shared_ptr<const GameBodies> inSlots() const { return table_.inSlots(); }
  /// Registered bodies; null: none. Every change makes a new object.
  [[nodiscard]] std::shared_ptr<const RegisteredBodies> registered() const { return registered_; }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] OrderReply take(CheckedOrders& orders, std::size_t waiting, const char* where);
  void prepare(CheckedOrders& orders);
  void takeBack(CheckedOrders& orders);
  bool takeBack(const Command& removal);
  void noteKept();
  void publish();

  BodyTable table_;
  Run* loop_ = nullptr;              ///< loop of a session that takes bodies; null: none
  std::vector<CheckedOrders> kept_;  ///< shapes and spawns for the next arming
  std::uint32_t kept_claim_ = 0;     ///< claim of the client that ordered them
  std::shared_ptr<const RegisteredBodies> registered_;  ///< as last published; null: none
  std::uint64_t published_version_ = 0, published_moves_ = 0;
  Clock::time_point published_at_;
};

}  // namespace wholehand
