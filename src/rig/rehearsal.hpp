#pragma once

#include "loop/core/body_order.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/renderer/haptic_renderer.hpp"
#include "loop/runtime/statistics.hpp"
#include "rig/models.hpp"
#include "rig/rig.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

class ArticulatedBody;
struct RehearsalOptions;

/// Issues commands that fill the slots of a game's scene with the costliest bodies that its budget
/// admits, and keeps these bodies at the hand. The budget's number of bodies is awake, half of them
/// free under gravity and half pulled into the hand; all other slots hold fixed bodies. Each body
/// has the largest number of pieces; the pieces are rods with the largest number of vertices and
/// overlap as far as prepareShapes() admits (docs/adr/0043-game-bodies-in-slots.md). Not real-time
/// safe.
class WorstCaseBodies {
 public:
  /// @param at pose of the hand when the bodies appear; they appear clear of it
  /// @param pieces pieces of every body; empty: the costliest pieces
  /// @pre budget.slots > 0 @pre models outlive this
  WorstCaseBodies(const Models& models, const GameBudget& budget, const AxisPosition& at,
                  std::vector<Shape> pieces = {});

  /// Writes the next commands into the record before its tick. Brings back a body that fell out of
  /// reach or left the world.
  void order(TickRecord& record);
  /// True when the spawn commands of all bodies were issued.
  [[nodiscard]] bool spawned() const noexcept { return spawned_; }
  /// Owner of the body in each slot. Slots without a free place near the hand stay empty.
  [[nodiscard]] const std::vector<BodyOwner>& owners() const noexcept { return owners_; }
  /// True when a slot's state in the record is that of an empty slot.
  [[nodiscard]] static bool isEmpty(const BodyState& slot) noexcept;
  /// Pieces of each body.
  [[nodiscard]] const std::vector<Shape>& pieces() const noexcept { return pieces_; }

 private:
  void makePieces(const GameBudget& budget);
  void centerPieces();
  void findPlaces(const GameBudget& budget, const AxisPosition& at);
  [[nodiscard]] bool isClear(const Eigen::Vector3d& place_m, const ArticulatedBody& hand) const;
  [[nodiscard]] SpawnOrder spawnOf(int slot) const;
  void respawnLost(int slot, const TickRecord& seen, const Eigen::Vector3d& grasp_centre_m);
  /// Middle of the space that the half-closed hand encloses.
  [[nodiscard]] Eigen::Vector3d graspCentre(const AxisPosition& q_s) const;

  const Models& models_;
  double mass_kg_ = 0.0, radius_m_ = 0.0;
  std::vector<Shape> pieces_;
  std::vector<Eigen::Vector3d> places_m_, targets_m_;  ///< per slot
  std::vector<BodyOwner> owners_;                      ///< per slot
  std::vector<int> generations_;                       ///< per slot
  std::vector<int> pause_;  ///< per slot: visits to skip until the record shows its spawn
  std::deque<Command> waiting_;
  std::size_t next_ = 0;  ///< next slot to update
  bool spawned_ = false;
};

/// Ticks measured with the slots of a game's scene filled (WorstCaseBodies).
struct PoolMeasurement {
  GameBudget budget;         ///< budget that the slots were filled to
  TickSummary summary;       ///< CPU time per tick and stage, contacts
  double limit_us = 0.0;     ///< limit on the 99.9th percentile
  int bodies_max = 0;        ///< most bodies in the world in one tick
  int moving_max = 0;        ///< most bodies that moved in one tick
  int driven = 0, free = 0;  ///< numbers of bodies pulled by the game and of bodies under gravity
  int attempts = 0;
  [[nodiscard]] bool passes() const { return 1e-3 * summary.cpu.p999_ns <= limit_us; }
};

/// Result of rehearsing the slots of a game's scene.
struct PoolRehearsal {
  PoolMeasurement measured;  ///< measurement with the budget of the file
  /// Largest number of awake bodies that passed; a number below the budget passed with a tenth of
  /// the limit to spare; 0: none passed.
  int awake = 0;
  int awake_alone = 0;  ///< if none passed: the same with bodies of one piece; 0: none
};

/// Fills the slots of a game's scene with the worst bodies that its budget admits, in a separate
/// world, and moves a strong hand through them in the calling thread as fast as possible. If a
/// tick's CPU time exceeds the limit, finds the largest number of awake bodies that passes by
/// bisection. Returns an error if the world became invalid, the slots cannot be filled, the hand
/// cannot be closed, or the call was cancelled. A later fault of the strong hand's own motion ends
/// the moves early; the ticks measured until then count. No state remains. Not real-time safe.
/// @param start initial pose of the session's hand
/// @pre models.scene.game.slots > 0 @pre no rig that uses these models' exercise is ticking
[[nodiscard]] Expected<PoolRehearsal> rehearsePool(const Models& models, const AxisPosition& start,
                                                   const RigOptions& rig,
                                                   const RehearsalOptions& options);

/// Diagnostic of a budget whose worst bodies take too long; names the time and the largest budget
/// that passes.
[[nodiscard]] Diagnostic poolTooSlow(const PoolRehearsal& pool, const Models& models);

/// "24 awake and 40 fixed bodies of a game, 4 pieces of 32 vertices each: 210 µs CPU at the median,
/// ..."
[[nodiscard]] std::string describe(const PoolMeasurement& pool);

/// Share of a period allowed for the 99.9th percentile of a tick's CPU time: half. Unlimited in
/// unoptimised and sanitizer builds, which are for debugging.
[[nodiscard]] double allowedPeriodShare() noexcept;

/// Options of a rehearsal.
struct RehearsalOptions {
  /// Limit on the 99.9th percentile of a tick's CPU time. With more than allowedPeriodShare() the
  /// rehearsal only informs: it does not permit arming.
  double allowed_period_share = allowedPeriodShare();
  int attempts = 3;  ///< number of attempts; the best counts, because CPU time is noisy
  /// Maximum number of bodies that the hand visits. A rehearsal that visits fewer bodies than the
  /// scene has only informs: it does not permit arming.
  int most_bodies = kMaxSceneBodies;
  /// If true, fills the slots of a game's scene with the worst bodies that its budget admits. If
  /// false, the rehearsal of such a scene only informs: it does not permit arming.
  bool fill_pool = true;
  std::function<bool()> cancelled;  ///< called before every tick; may be null
  /// Called with a description before a measurement that takes seconds; may be null.
  std::function<void(const std::string&)> status;
  /// CPU time added to that of a tick with the slots filled [ns]; values below 0 count as 0. Null:
  /// none. For tests.
  std::function<std::int64_t(const TickRecord&)> extra_ns;
};

/// Result of a rehearsal.
struct Rehearsal {
  TickSummary summary;                  ///< best attempt: CPU time per tick and stage, contacts
  double limit_us = 0.0;                ///< limit on the 99.9th percentile
  Stage slowest = Stage::kPhysicsStep;  ///< stage that takes most of the time in the slow ticks
  std::string heaviest;       ///< body with the most contacts in the slow ticks; empty: none
  int heaviest_contacts = 0;  ///< largest simultaneous number of its contacts
  int bodies = 0, bodies_touched = 0;
  /// Share of ticks before a touch in which the contact forces did not settle.
  double unsettled = 0.0;
  int attempts = 0;
  std::optional<PoolMeasurement> pool;    ///< with the slots of a game filled; empty: not done
  std::optional<RehearsalPassed> passed;  ///< permission for arm()
};

/// Rehearses a scene: runs its worst contacts with a simulated device on this machine, as fast as
/// possible, in the calling thread. The palm presses against every body within reach while all
/// fingers close; then the back of the fingers presses. This allocates memory, warms caches and
/// measures each tick's CPU time per stage before any force is rendered to a person. The slots of a
/// game's scene are then filled with the worst bodies that the budget admits (rehearsePool()).
/// Returns an error if the 99.9th percentile exceeds the limit (the error names the stage and what
/// to remove, or the largest budget that passes), if the world became invalid, or if the call was
/// cancelled. No state remains: the next arm() resets the exercise that the models share. Not
/// real-time safe.
/// @param start initial pose of the session's hand
/// @pre no rig that uses these models' exercise is ticking
[[nodiscard]] Expected<Rehearsal> rehearse(const Models& models, const AxisPosition& start,
                                           const RigOptions& rig,
                                           const RehearsalOptions& options = {});

/// "61 µs CPU at the median, 143 p99.9, 180 at most (500 allowed), mostly physics_step; 23 contacts
/// with 7 of 9 bodies"
[[nodiscard]] std::string describe(const Rehearsal& rehearsal);

}  // namespace wholehand
