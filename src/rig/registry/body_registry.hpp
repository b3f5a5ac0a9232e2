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

/// Computes what the hand could touch within a time from its current posture.
///
/// Every axis may move at its speed limit, above which rendering stops, and at most to the end of
/// its range. The end of a capsule then moves by at most the norm over the translations plus, to
/// first order, |∂p/∂q_a| |Δq_a| for each rotation. Not real-time safe.
class HandReach {
 public:
  /// @pre both outlive this
  HandReach(const HandModel& hand, const DeviceModel& device, double within_s);

  /// Sets the current posture of the hand.
  void look(const AxisPosition& q_s, const JointPosition& theta);

  struct Distance {
    /// Current distance between the hand's surface and the ball; negative: overlap.
    double now_m = 0.0;
    /// Distance by which the hand misses the ball within the time; <= 0: it reaches it.
    double missed_m = 0.0;
  };
  /// Distances to a ball. If the hand misses the ball by more than `far_m`, the results may be too
  /// small.
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
  std::vector<Finger> capsules_;  ///< capsules in the world
  Eigen::Vector3d middle_m_ = Eigen::Vector3d::Zero();
  double farthest_m_ = 0.0;  ///< largest distance from the middle that the hand reaches
  double extent_m_ = 0.0;    ///< largest distance of the hand's surface from the middle
};

inline constexpr double kReachWithin_s = 0.25;  ///< time in which the hand could reach a body

/// Registry for a game with more bodies than the loop has slots
/// (docs/adr/0054-which-bodies-get-a-slot.md). It works outside the loop: it reads records and
/// issues ordinary commands. Bodies that the hand could touch within 0.25 s get slots, the nearest
/// first. A body that leaves its slot keeps the pose and the velocity that the loop gave it. For
/// one thread at a time; not real-time safe.
class BodyRegistry {
 public:
  /// Begins a session with empty slots. Registered bodies stay registered.
  /// @param first_body index of the first slot's body in the record
  /// @param refused_event type of the exercise's event "refused"; -1: none
  /// @pre hand and device outlive the session
  void begin(const HandModel& hand, const DeviceModel& device, const GameBudget& budget,
             int first_body, int refused_event);
  /// Ends the session. Bodies in slots become out of reach.
  void end();
  /// Forgets all bodies.
  void clear();

  /// Registers a body; `order.slot` is its number. `refuse_overlap` is ignored.
  /// @param radius_m radius of a ball about the centre of mass that contains all shapes
  [[nodiscard]] BodyRefusal add(const SpawnOrder& order, double radius_m);
  /// Removes, teleports, hands over or moves a body; Command::index is its number.
  [[nodiscard]] BodyRefusal apply(const Command& command);
  /// True while a registered body has this slot or is entering or leaving it.
  [[nodiscard]] bool holds(int slot) const { return held_[slot].number != 0; }
  /// Reserves the slot for a spawn by another program until the record shows its body.
  void leaveToOthers(int slot) { others_until_s_[slot] = time_s_ + kAnswered_s; }
  /// Processes the next record of the session.
  void onRecord(const TickRecord& record);

  /// Commands for the loop, in order. The caller removes the commands that it has sent. New
  /// commands are only issued when the list is empty.
  [[nodiscard]] std::deque<Command>& forLoop() noexcept { return for_loop_; }
  [[nodiscard]] bool usesShapes(int shape_set) const;
  /// Changes whenever a body is added, is removed or changes its whereabouts.
  [[nodiscard]] std::uint64_t version() const noexcept { return version_; }
  /// Changes whenever a body without a slot is moved.
  [[nodiscard]] std::uint64_t moves() const noexcept { return moves_; }
  [[nodiscard]] std::vector<RegisteredBody> bodies() const;  ///< by number
  [[nodiscard]] std::size_t count() const noexcept { return bodies_.size(); }

 private:
  static constexpr double kAnswered_s = 0.5;  ///< time within which a spawn appears in the record
  /// Generations reserved for the registry. A game numbers its bodies from 1.
  static constexpr int kFirstGeneration = 1 << 23, kLastGeneration = (1 << 24) - 1;

  struct Body {
    SpawnOrder spawn;  ///< spawn order with the newest pose and velocity
    double radius_m = 0.0;
    int slot = -1;
    bool moved_away = false;  ///< a command moved the body while it was leaving its slot
    Whereabouts whereabouts = Whereabouts::kOutOfReach;
    double not_before_s = 0.0;  ///< earliest next try after the loop refused it
  };
  /// State of a slot held by a registered body.
  struct HeldBody {
    int number = 0;      ///< 0: free; -1: its body is no longer registered
    int generation = 0;  ///< generation in the loop
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
  // Choice of the bodies that have slots.
  void choose(const TickRecord& record);
  [[nodiscard]] std::optional<double> rankOf(const Body& body) const;
  [[nodiscard]] std::vector<Candidate> candidates();
  void giveSlots(const std::vector<int>& wanted, const TickRecord& record);
  [[nodiscard]] bool mustStay(const HeldBody& held) const;
  [[nodiscard]] int freeOne(const TickRecord& record) const;
  [[nodiscard]] int movingNow(const TickRecord& record) const;
  void enter(Body& body, int slot);
  void leave(int slot);

  std::map<int, Body> bodies_;  ///< by number
  std::array<HeldBody, kMaxSlots> held_{};
  std::array<bool, kMaxSlots> fixed_{};  ///< true for fixed bodies spawned by other programs
  std::array<double, kMaxSlots> others_until_s_{};
  GameBudget budget_;
  std::unique_ptr<HandReach> reach_;  ///< null: no session
  int first_body_ = 0, refused_event_ = -1, last_generation_ = 0;
  double time_s_ = 0.0, chosen_s_ = 0.0, silent_since_s_ = -1.0;
  std::deque<Command> for_loop_;
  std::uint64_t version_ = 0, moves_ = 0;
};

}  // namespace wholehand
