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

/// Orders that fill the slots of a game's scene with the costliest bodies that its budget admits,
/// and keep them at the hand: as many awake bodies as the budget says, half of them free under
/// gravity and half pulled into the hand, and fixed bodies in all other slots. Each has the most
/// pieces, rods of the most vertices, which overlap as far as prepareShapes() admits
/// (docs/adr/0043-bodies-of-a-game.md). Not real-time safe.
class PoolFilling {
 public:
  /// @param at pose of the hand when the bodies appear; they appear clear of it
  /// @param pieces of every body, in place of the costliest
  /// @pre budget.slots > 0 @pre models outlive this
  PoolFilling(const Models& models, const GameBudget& budget, const AxisPosition& at,
              std::vector<Shape> pieces = {});

  /// Writes the next orders into the record, before its tick. A body that fell out of reach, or
  /// left the world, comes back.
  void order(TickRecord& record);
  /// True once every body was ordered to appear.
  [[nodiscard]] bool spawned() const noexcept { return spawned_; }
  /// Who moves the body of a slot. Slots without a free place near the hand stay empty.
  [[nodiscard]] const std::vector<BodyOwner>& owners() const noexcept { return owners_; }
  /// True where a slot's state in the record is that of an empty one.
  [[nodiscard]] static bool isEmpty(const BodyState& slot) noexcept;
  /// Pieces of each body, as ordered.
  [[nodiscard]] const std::vector<Shape>& pieces() const noexcept { return pieces_; }

 private:
  void makePieces(const GameBudget& budget);
  void centerPieces();
  void findPlaces(const GameBudget& budget, const AxisPosition& at);
  [[nodiscard]] bool isClear(const Eigen::Vector3d& place_m, const ArticulatedBody& hand) const;
  [[nodiscard]] SpawnOrder spawnOf(int slot) const;
  void tend(int slot, const TickRecord& seen, const Eigen::Vector3d& pocket_m);
  /// Middle of the space that the half-closed hand encloses.
  [[nodiscard]] Eigen::Vector3d pocketAt(const AxisPosition& q_s) const;

  const Models& models_;
  double mass_kg_ = 0.0, radius_m_ = 0.0;
  std::vector<Shape> pieces_;
  std::vector<Eigen::Vector3d> places_m_, targets_m_;  ///< per slot
  std::vector<BodyOwner> owners_;                      ///< per slot
  std::vector<int> generations_;                       ///< per slot
  std::vector<int> pause_;  ///< per slot: times to leave it alone, until the record shows its spawn
  std::deque<Command> waiting_;
  std::size_t next_ = 0;  ///< slot that is tended next
  bool spawned_ = false;
};

/// Ticks measured with the slots of a game's scene filled (PoolFilling).
struct PoolMeasurement {
  GameBudget budget;         ///< filled
  TickSummary summary;       ///< CPU time per tick and stage, contacts
  double limit_us = 0.0;     ///< limit on the 99.9th percentile
  int bodies_max = 0;        ///< most bodies in the world in one tick
  int moving_max = 0;        ///< most bodies that moved in one tick
  int driven = 0, free = 0;  ///< bodies that were pulled by the game, or fell
  int attempts = 0;
  [[nodiscard]] bool passes() const { return 1e-3 * summary.cpu.p999_ns <= limit_us; }
};

/// Result of rehearsing the slots of a game's scene.
struct PoolRehearsal {
  PoolMeasurement measured;  ///< with the budget of the file
  /// Most awake bodies that passed, with a tenth of the limit to spare unless it is the budget; 0:
  /// none.
  int awake = 0;
  int awake_alone = 0;  ///< if none passed: as `awake`, with bodies of one piece; 0: none
};

/// Fills the slots of a game's scene with the worst bodies that its budget admits, in a world of
/// its own, and moves a strong hand through them, in the calling thread and as fast as possible.
/// Where a tick's CPU time exceeds the limit, halves the awake bodies until the largest number that
/// passes is found. Refused where the world became invalid, where the slots cannot be filled, where
/// the hand cannot be closed, or where it was cancelled. A fault of the strong hand's own motion
/// later on ends the moves early: what was measured counts. No state remains. Not real-time safe.
/// @param start initial pose of the session's hand
/// @pre models.scene.game.slots > 0 @pre no rig that uses these models' exercise is ticking
[[nodiscard]] Expected<PoolRehearsal> rehearsePool(const Models& models, const AxisPosition& start,
                                                   const RigOptions& rig,
                                                   const RehearsalOptions& options);

/// Diagnostic of a budget whose worst bodies take too long: the time, and the largest that passes.
[[nodiscard]] Diagnostic poolTooSlow(const PoolRehearsal& pool, const Models& models);

/// "24 awake and 40 fixed bodies of a game, 4 pieces of 32 vertices each: 210 µs CPU at the median,
/// ..."
[[nodiscard]] std::string describe(const PoolMeasurement& pool);

/// Share of a period allowed for the 99.9th percentile of a tick's CPU time: half. Unlimited in
/// unoptimised and sanitizer builds, which are for debugging.
[[nodiscard]] double mostOfPeriod() noexcept;

/// Options of a rehearsal.
struct RehearsalOptions {
  /// Limit on the 99.9th percentile of a tick's CPU time. With more than mostOfPeriod() the
  /// rehearsal only informs: it does not permit arming.
  double most_of_period = mostOfPeriod();
  int attempts = 3;  ///< CPU time is noisy; the best attempt counts
  /// Most bodies that the hand visits. A rehearsal of fewer bodies than the scene has only informs:
  /// it does not permit arming.
  int most_bodies = kMaxSceneBodies;
  /// Fill the slots of a game's scene with the worst bodies that its budget admits. Without it the
  /// rehearsal of such a scene only informs: it does not permit arming.
  bool fill_pool = true;
  std::function<bool()> cancelled;  ///< called before every tick; may be null
  /// Called with what is about to be measured, where it takes seconds; may be null.
  std::function<void(const std::string&)> status;
  /// CPU time added to that of a tick with the slots filled [ns]; values below 0 count as 0. Null:
  /// none. For tests.
  std::function<std::int64_t(const TickRecord&)> extra_ns;
};

/// Result of a rehearsal.
struct Rehearsal {
  TickSummary summary;    ///< of the best attempt: CPU time per tick and stage, contacts
  double limit_us = 0.0;  ///< limit on the 99.9th percentile
  Stage slowest = Stage::kPhysicsStep;  ///< stage that takes most of the slow ticks
  std::string heaviest;                 ///< body most touched in them; empty: none
  int heaviest_contacts = 0;            ///< largest simultaneous number of its contacts
  int bodies = 0, bodies_touched = 0;
  double unsettled = 0.0;  ///< share of ticks before a touch whose forces did not settle
  int attempts = 0;
  std::optional<PoolMeasurement> pool;    ///< with the slots of a game filled; empty: not done
  std::optional<RehearsalPassed> passed;  ///< permission for arm()
};

/// Rehearses a scene: runs its worst contacts against a simulated device on this machine, as fast
/// as possible, in the calling thread. The palm presses against every body within reach while all
/// fingers close, then the back of the fingers does. This allocates memory, warms caches and
/// measures each tick's CPU time per stage before any person feels a force. The slots of a game's
/// scene are then filled with the worst bodies that the budget admits (rehearsePool()). Refused
/// where the 99.9th percentile exceeds the limit (the error names the stage and what to remove, or
/// the largest budget that passes), where the world became invalid, or where it was cancelled.
/// No state remains: the next arm() resets the exercise that the models share. Not real-time safe.
/// @param start initial pose of the session's hand
/// @pre no rig that uses these models' exercise is ticking
[[nodiscard]] Expected<Rehearsal> rehearse(const Models& models, const AxisPosition& start,
                                           const RigOptions& rig,
                                           const RehearsalOptions& options = {});

/// "61 µs CPU at the median, 143 p99.9, 180 at most (500 allowed), mostly physics_step; 23 contacts
/// with 7 of 9 bodies"
[[nodiscard]] std::string describe(const Rehearsal& rehearsal);

}  // namespace wholehand
