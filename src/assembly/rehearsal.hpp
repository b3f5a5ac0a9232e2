#pragma once

#include "assembly/models.hpp"
#include "assembly/pool_rehearsal.hpp"
#include "assembly/rig.hpp"
#include "renderer/haptic_renderer.hpp"
#include "telemetry/statistics.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace wholehand {

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
