#pragma once

#include "loop/core/body_order.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/game_shapes.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"
#include "rig/registry/hand_reach.hpp"

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

inline constexpr double kReachWithin_s = 0.25;  ///< time in which the hand could reach a body

/// All bodies of a game, outside the loop (docs/adr/0100-one-table-of-bodies.md): what is in each
/// slot, the shapes, and up to 1,000 registered bodies, of which those that the hand could touch
/// within 0.25 s get slots, the nearest first (docs/adr/0054-which-bodies-get-a-slot.md). It reads
/// the loop's records and issues ordinary commands; the loop does not depend on it. A registered
/// body that leaves its slot keeps the pose and the velocity that the loop gave it. For one thread
/// at a time; not real-time safe.
class BodyTable {
 public:
  BodyTable() { end(); }
  /// Begins a session: no shapes, empty slots. Registered bodies stay registered.
  /// @param first_body index of the first slot's body in the record
  /// @param event_names event names of the session's exercise
  /// @pre hand and device outlive the session
  void begin(const HandModel& hand, const DeviceModel& device, const GameBudget& budget,
             int first_body, const std::vector<std::string>& event_names);
  /// Begins a session whose commands others give, as a recording has: only slots are followed.
  void follow(const std::vector<std::string>& event_names);
  /// Ends the session: forgets shapes and slots. Registered bodies become out of reach.
  void end();
  /// Forgets the registered bodies.
  void clear();

  // Orders. Each is checked before it is taken; a number that is out of range is refused too.

  /// Takes the shapes of a set, whose commands the caller gives to the loop; kShapesBusy while a
  /// body has the set.
  [[nodiscard]] BodyRefusal prepare(int set, std::shared_ptr<const GameShapes> shapes);
  /// Takes an order. Command::index is a slot or the number of a registered body: the caller gives
  /// orders to slots to the loop. `refuse_overlap` is ignored for a registered body.
  [[nodiscard]] BodyRefusal order(const Command& command);
  /// Takes shapes or a spawn that the loop has been given in any case.
  void noteShapes(int set, std::shared_ptr<const GameShapes> shapes);
  void noteSpawn(const SpawnOrder& spawn);
  /// Forgets the spawn under way in a slot after it was cancelled.
  void withdraw(int slot) { slots_[slot].next = Slot::Next{}; }
  /// Processes the next record of the session.
  void onRecord(const TickRecord& record);
  /// Commands for the loop, in order. The caller removes the commands that it has sent. The table
  /// gives slots only while the list is empty.
  [[nodiscard]] std::deque<Command>& forLoop() noexcept { return for_loop_; }

  /// True while a registered body has this slot or is entering or leaving it.
  [[nodiscard]] bool holds(int slot) const { return slots_[slot].holder.number != 0; }
  [[nodiscard]] bool isRegisteredSet(int set) const;  ///< a registered body has these shapes
  /// Shapes of this session; null: none with this number.
  [[nodiscard]] std::shared_ptr<const GameShapes> shapesOf(int set) const;
  /// Bodies in slots; null when there are none. Every change makes a new object.
  [[nodiscard]] std::shared_ptr<const GameBodies> inSlots() const { return in_slots_; }
  [[nodiscard]] RegisteredBodies registered() const;  ///< by number
  /// Changes whenever a body is registered, is removed or changes its whereabouts.
  [[nodiscard]] std::uint64_t version() const noexcept { return version_; }
  /// Changes whenever a registered body without a slot is moved.
  [[nodiscard]] std::uint64_t moves() const noexcept { return moves_; }

 private:
  static constexpr double kAnswered_s = 0.5;  ///< time within which a spawn appears in the record
  /// Generations reserved for registered bodies. A game numbers its bodies from 1.
  static constexpr int kFirstGeneration = 1 << 23, kLastGeneration = (1 << 24) - 1;

  enum Event { kAppeared, kSolid, kLettingGo, kLeft, kRefused, kEvents };
  struct Body {
    SpawnOrder spawn;  ///< spawn order with the newest pose and velocity
    std::shared_ptr<const GameShapes> shapes;
    int slot = -1;
    bool moved_away = false;  ///< a command moved the body while it was leaving its slot
    Whereabouts whereabouts = Whereabouts::kOutOfReach;
    double not_before_s = 0.0;  ///< earliest next try after the loop refused it
  };
  struct Slot {
    /// A spawn that the loop has not answered yet.
    struct Next {
      int generation = 0;  ///< 0: none
      int shape_set = -1;
      std::shared_ptr<const GameShapes> shapes;
      std::uint64_t until_tick = 0;  ///< without an answer by then it counts as refused
    } next;
    /// The body in the slot, by the loop's events.
    struct Now {
      int shape_set = -1;
      GameBody body;  ///< generation 0: none
    } now;
    /// The registered body that has the slot.
    struct Holder {
      int number = 0;      ///< 0: none; -1: its body is no longer registered
      int generation = 0;  ///< generation in the loop
      bool seen = false, leaving = false;
      double since_s = 0.0, touched_s = -1.0;
    } holder;
    bool moves = true;            ///< false: the body in the slot is fixed
    double others_until_s = 0.0;  ///< kept for a spawn of the game itself until then
  };
  struct Candidate {
    double rank_m = 0.0;
    int number = 0;
  };

  [[nodiscard]] bool isWaiting(const Slot& slot) const;
  [[nodiscard]] Body* find(int number);
  [[nodiscard]] bool parked(int slot, const TickRecord& record) const;
  void expect(int index, const SpawnOrder& spawn);
  void setWhereabouts(Body& body, Whereabouts whereabouts);
  BodyRefusal add(const SpawnOrder& spawn);
  BodyRefusal orderRegistered(const Command& command);
  BodyRefusal orderInSlot(Body& body, const Command& command);
  void take(const ExerciseEvent& event);
  void takeState(Event what, int slot, int generation);
  void noteRecord(const TickRecord& record);
  void followSlot(int slot, const TickRecord& record);
  void keepState(int slot, const BodyState& state);
  void freeSlot(int slot);
  void publish();
  // Choice of the registered bodies that have slots.
  void choose(const TickRecord& record);
  [[nodiscard]] std::optional<double> rankOf(const Body& body) const;
  [[nodiscard]] std::vector<Candidate> candidates();
  void giveSlots(const std::vector<int>& wanted, const TickRecord& record);
  [[nodiscard]] bool mustStay(const Slot::Holder& holder) const;
  [[nodiscard]] int freeOne(const TickRecord& record) const;
  [[nodiscard]] int movingNow(const TickRecord& record) const;
  void enter(Body& body, int slot);
  void leave(int slot);

  std::array<std::shared_ptr<const GameShapes>, kMaxShapeSets> sets_;
  std::array<Slot, kMaxSlots> slots_;
  std::map<int, Body> bodies_;  ///< registered bodies, by number
  GameBudget budget_;
  std::unique_ptr<HandReach> reach_;   ///< null: registered bodies get no slots
  std::array<int, kEvents> events_{};  ///< event types of the exercise; -1: it has none
  int first_body_ = 0, last_generation_ = 0;
  std::uint64_t tick_ = 0;
  double time_s_ = 0.0, chosen_s_ = 0.0, silent_since_s_ = -1.0;
  std::deque<Command> for_loop_;
  bool changed_ = false;  ///< in_slots_ is older than slots_
  std::shared_ptr<const GameBodies> in_slots_;
  std::uint64_t version_ = 0, moves_ = 0;
};

}  // namespace wholehand
