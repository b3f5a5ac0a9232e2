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

/// What a message of a game comes to: commands for the loop, and the items that are refused.
struct CheckedOrders {
  std::vector<Command> commands;
  std::vector<RefusedItem> refused;
  std::map<int, int> item_of_slot;  ///< index in the message, of slots and registered bodies
  int shape_set = -1;               ///< of `shapes`
  std::shared_ptr<const GameShapes> shapes;  ///< that the commands hand over; null: none
};

/// Checks every number of a message against the scene's budget, and prepares shapes. An item that
/// is refused has no command; shapes are refused as a whole. Orders to registered bodies are among
/// the commands. Not real-time safe. Any thread.
/// @param shapes_id GameShapes::id of what it prepares
[[nodiscard]] CheckedOrders checkOrders(const BodyOrders& orders, const GameBudget& budget,
                                        std::uint32_t shapes_id);

/// Reply to a message some of whose items are refused; accepted when there are none.
[[nodiscard]] OrderReply replyFor(std::vector<RefusedItem> refused);

/// Knows which bodies of a game are in the world, and their shapes: from the orders handed to the
/// loop, and from what the events of its records say became of them. For pictures, and to refuse
/// early what the loop would refuse; the loop itself does not depend on it. One thread at a time.
class GameBodyTracker {
 public:
  GameBodyTracker() { reset(); }
  /// Forgets everything: a session begins or ends.
  /// @param event_names of the session's exercise; empty: it takes no bodies
  void reset(const std::vector<std::string>& event_names = {});
  /// Refuses what cannot be obeyed now: shapes that a body has, a spawn over another one under way.
  /// Removes it from `orders`.
  void refuseBusy(CheckedOrders& orders);
  /// Notes commands that are about to be handed to the loop.
  void note(const CheckedOrders& orders);
  void noteSpawn(const Command& spawn);
  /// Shapes that were prepared in this session; null: none.
  [[nodiscard]] std::shared_ptr<const GameShapes> shapesOf(int shape_set) const;
  /// Forgets the spawn under way in a slot: it was taken back.
  void withdraw(int slot);
  /// Takes a record, in order.
  void see(const TickRecord& record);
  /// Null when there are none. A change makes a new object.
  [[nodiscard]] std::shared_ptr<const GameBodies> bodies() const { return bodies_; }
  /// Type of the exercise's event that says what the loop refused; -1: it has none.
  [[nodiscard]] int refusedEvent() const { return types_[kRefused]; }

 private:
  enum Event { kAppeared, kSolid, kLettingGo, kLeft, kRefused, kEvents };
  struct Pending {
    int generation = 0;  ///< of a spawn under way; 0: none
    int shape_set = -1;
    std::shared_ptr<const GameShapes> shapes;
    std::uint64_t until_tick = 0;  ///< then it is taken for refused
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
  std::uint64_t tick_ = 0;            ///< of the newest record
  std::array<std::shared_ptr<const GameShapes>, kMaxShapeSets> sets_;
  std::array<Pending, kMaxSlots> pending_;
  std::array<Present, kMaxSlots> present_;
  bool changed_ = false;
  std::shared_ptr<const GameBodies> bodies_;
};

}  // namespace wholehand
