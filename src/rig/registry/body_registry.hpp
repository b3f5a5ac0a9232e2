#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/body_order.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace wholehand {

/// What the hand could touch within a time, from where it is.
///
/// Every axis moves at its speed limit, above which rendering stops, and at most to the end of its
/// range. A capsule's end then gets as far as the norm over the translations, and to first order
/// |∂p/∂q_a| |Δq_a| further for each rotation. Not real-time safe.
class HandReach {
 public:
  /// @pre both outlive this
  HandReach(const HandModel& hand, const DeviceModel& device, double within_s);

  /// Takes a posture of the hand.
  void look(const AxisPosition& q_s, const JointPosition& theta);

  struct Distance {
    double now_m = 0.0;  ///< between the hand's surface and the ball; negative: they overlap
    double missed_m =
        0.0;  ///< by which the hand misses the ball within the time; <= 0: it does not
  };
  /// Of a ball. One that the hand misses by more than `far_m` may have too small a distance.
  [[nodiscard]] Distance to(const Eigen::Vector3d& centre_m, double radius_m, double far_m) const;

 private:
  struct Finger {
    Eigen::Vector3d a_m, b_m;
    double radius_m = 0.0, travel_m = 0.0;
  };
  [[nodiscard]] double travelOf(int link, const Eigen::Vector3d& point_m,
                                const AxisPosition& change) const;

  const HandModel& hand_;
  const DeviceModel& device_;
  const double within_s_;
  ArticulatedBody body_;
  std::vector<Finger> capsules_;  ///< in the world
  Eigen::Vector3d middle_m_ = Eigen::Vector3d::Zero();
  double farthest_m_ = 0.0;  ///< from the middle, of all that the hand reaches
  double extent_m_ = 0.0;    ///< from the middle, of the hand
};

inline constexpr double kReachWithin_s = 0.25;  ///< in which the hand could come to a body

/// The bodies of a game that are more than the loop has slots for (docs/adr/0054-reach.md). Stands
/// outside the loop: sees its records, and has ordinary commands for it. The bodies that the hand
/// could touch within 0.25 s get slots, the nearest first; what leaves its slot keeps the pose and
/// the velocity that the loop gave it. One thread at a time; not real-time safe.
class BodyRegistry {
 public:
  /// A session begins: all slots are empty. Bodies that are registered stay.
  /// @param first_body of the slots in the record
  /// @param refused_event type of the exercise's event "refused"; -1: none
  /// @pre hand and device outlive the session
  void begin(const HandModel& hand, const DeviceModel& device, const GameBudget& budget,
             int first_body, int refused_event);
  /// The session is over: what was in a slot is out of reach.
  void end();
  /// Forgets all bodies.
  void clear();

  /// Registers a body; `order.slot` is its number. `refuse_overlap` is not heeded.
  /// @param radius_m of a ball about the centre of mass that holds its shapes
  [[nodiscard]] BodyRefusal add(const SpawnOrder& order, double radius_m);
  /// Removes, teleports, hands over or moves a body; Command::index is its number.
  [[nodiscard]] BodyRefusal obey(const Command& command);
  /// True while a registered body has this slot, or is on its way into or out of it.
  [[nodiscard]] bool holds(int slot) const { return held_[slot].number != 0; }
  /// Somebody else spawns into this slot: it is left to them until the record shows the body.
  void leaveToOthers(int slot) { others_until_s_[slot] = time_s_ + kAnswered_s; }
  /// Takes the next record of the session.
  void see(const TickRecord& record);

  /// Commands for the loop, in order. Take those that were handed over out. New ones are decided
  /// on only when there are none.
  [[nodiscard]] std::deque<Command>& forLoop() noexcept { return for_loop_; }
  [[nodiscard]] bool usesShapes(int shape_set) const;
  /// Changes whenever a body comes, leaves, or changes its whereabouts.
  [[nodiscard]] std::uint64_t version() const noexcept { return version_; }
  /// Changes whenever a body without a slot is moved.
  [[nodiscard]] std::uint64_t moves() const noexcept { return moves_; }
  [[nodiscard]] std::vector<RegisteredBody> bodies() const;  ///< by number
  [[nodiscard]] std::size_t count() const noexcept { return bodies_.size(); }

 private:
  static constexpr double kAnswered_s = 0.5;  ///< in which a spawn shows in the record
  /// A game names its bodies from 1 on: these generations are the registry's own.
  static constexpr int kFirstGeneration = 1 << 23, kLastGeneration = (1 << 24) - 1;

  struct Body {
    SpawnOrder spawn;  ///< with the newest pose and velocity
    double radius_m = 0.0;
    int slot = -1;
    bool moved_away = false;  ///< it was ordered elsewhere while its slot is being left
    Whereabouts whereabouts = Whereabouts::kOutOfReach;
    double not_before_s = 0.0;  ///< the loop refused it
  };
  /// A slot that a registered body has.
  struct Held {
    int number = 0;      ///< 0: free; -1: its body is no longer registered
    int generation = 0;  ///< in the loop
    bool moves = false, seen = false, leaving = false;
    double since_s = 0.0, touched_s = -1.0;
  };
  struct Candidate {
    double rank_m = 0.0;
    int number = 0;
  };

  [[nodiscard]] Body* find(int number);
  [[nodiscard]] bool parked(int slot, const TickRecord& record) const;
  void setWhereabouts(Body& body, Whereabouts whereabouts);
  BodyRefusal orderInSlot(Body& body, const Command& command);
  void watchOthers(const TickRecord& record);
  void followSlot(int slot, const TickRecord& record);
  void keepState(int slot, const BodyState& state);
  void freeSlot(int slot);
  void noteRefused(const TickRecord& record);
  // which of them have slots
  void choose(const TickRecord& record);
  [[nodiscard]] std::optional<double> rankOf(const Body& body) const;
  [[nodiscard]] std::vector<Candidate> candidates();
  void giveSlots(const std::vector<int>& wanted, const TickRecord& record);
  [[nodiscard]] bool mustStay(const Held& held) const;
  [[nodiscard]] int freeOne(const TickRecord& record) const;
  [[nodiscard]] int movingNow(const TickRecord& record) const;
  void enter(Body& body, int slot);
  void leave(int slot);

  std::map<int, Body> bodies_;  ///< by number
  std::array<Held, kMaxSlots> held_{};
  std::array<bool, kMaxSlots> fixed_{};  ///< of bodies that others spawned
  std::array<double, kMaxSlots> others_until_s_{};
  GameBudget budget_;
  std::unique_ptr<HandReach> reach_;  ///< null: no session
  int first_body_ = 0, refused_event_ = -1, last_generation_ = 0;
  double time_s_ = 0.0, chosen_s_ = 0.0, silent_since_s_ = -1.0;
  std::deque<Command> for_loop_;
  std::uint64_t version_ = 0, moves_ = 0;
};

}  // namespace wholehand
