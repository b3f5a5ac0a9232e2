#pragma once

#include "assembly/models.hpp"
#include "assembly/rig.hpp"
#include "core/expected.hpp"
#include "model/scene/scene_model.hpp"
#include "telemetry/statistics.hpp"

#include <string>

namespace wholehand {

struct RehearsalOptions;

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

}  // namespace wholehand
