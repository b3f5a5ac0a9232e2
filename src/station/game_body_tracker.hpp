#pragma once

#include "loop/core/tick_record.hpp"
#include "vocabulary/backend.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Result of checking a game's message: commands for the loop, and the refused items.
struct CheckedOrders {
  std::vector<Command> commands;
  std::vector<RefusedItem> refused;
  std::map<int, int> item_of_slot;  ///< index in the message, by slot or number of a registered
                                    ///< body
  int shape_set = -1;               ///< set number of `shapes`
  std::shared_ptr<const GameShapes> shapes;  ///< prepared shapes that the commands hand over; null:
                                             ///< none
};

/// Checks every number of a message against the scene's budget, and prepares shapes. A refused item
/// has no command; shapes are refused as a whole. The commands include those for registered bodies.
/// Not real-time safe. Any thread.
/// @param shapes_id GameShapes::id for the prepared shapes
[[nodiscard]] CheckedOrders checkOrders(const BodyOrders& orders, const GameBudget& budget,
                                        std::uint32_t shapes_id);

/// Makes the reply to a message with refused items; accepted when `refused` is empty.
[[nodiscard]] OrderReply replyFor(std::vector<RefusedItem> refused);

/// Tracks which bodies of a game are in the world, and their shapes. Its sources are the orders
/// handed to the loop and the events in the loop's records. It serves the pictures of the bodies,
/// and refuses early what the loop would refuse. The loop does not depend on it. One thread at a
/// time.
class GameBodyTracker {
 public:
  GameBodyTracker() { reset(); }
  /// Forgets everything at the begin or end of a session.
  /// @param event_names event names of the session's exercise; empty: the exercise takes no bodies
  void reset(const std::vector<std::string>& event_names = {});
  /// Refuses orders that cannot be obeyed now: shapes in use by a body, or a spawn into a slot
  /// where another spawn is under way. Removes these orders from `orders`.
  void refuseBusy(CheckedOrders& orders);
  /// Records commands that are about to be handed to the loop.
  void note(const CheckedOrders& orders);
  void noteSpawn(const Command& spawn);
  /// Shapes prepared in this session; null: none with this number.
  [[nodiscard]] std::shared_ptr<const GameShapes> shapesOf(int shape_set) const;
  /// Forgets the spawn under way in a slot after it was cancelled.
  void withdraw(int slot);
  /// Receives the loop's records in order.
  void onRecord(const TickRecord& record);
  /// Bodies in the world; null when there are none. Every change makes a new object.
  [[nodiscard]] std::shared_ptr<const GameBodies> bodies() const { return bodies_; }
  /// Type of the exercise's event that reports a refusal by the loop; -1: the exercise has none.
  [[nodiscard]] int refusedEvent() const { return types_[kRefused]; }

 private:
  enum Event { kAppeared, kSolid, kLettingGo, kLeft, kRefused, kEvents };
  struct Pending {
    int generation = 0;  ///< generation of a spawn under way; 0: none
    int shape_set = -1;
    std::shared_ptr<const GameShapes> shapes;
    std::uint64_t until_tick = 0;  ///< tick after which a spawn without a result counts as refused
  };
  struct Present {
    int generation = 0;  ///< 0: none
    int shape_set = -1;
    GameBody body;
  };

  [[nodiscard]] bool inUse(int shape_set) const;
  void expect(const SpawnOrder& spawn);
  void take(const ExerciseEvent& event);
  void takeState(Event what, int slot, int generation);
  void publish();

  std::array<int, kEvents> types_{};  ///< event types of the exercise; -1: it has none
  std::uint64_t tick_ = 0;            ///< tick of the newest record
  std::array<std::shared_ptr<const GameShapes>, kMaxShapeSets> sets_;
  std::array<Pending, kMaxSlots> pending_;
  std::array<Present, kMaxSlots> present_;
  bool changed_ = false;
  std::shared_ptr<const GameBodies> bodies_;
};

}  // namespace wholehand
