#pragma once

#include "assembly/models.hpp"
#include "assembly/rig.hpp"
#include "realtime/sanitized.hpp"
#include "telemetry/statistics.hpp"

#include <functional>
#include <string>

namespace wholehand {

#if WHOLEHAND_SANITIZED || !defined(__OPTIMIZE__)
inline constexpr double kMostOfPeriod = 100.0;  ///< such a program is for finding mistakes
#else
inline constexpr double kMostOfPeriod = 0.5;
#endif

/// How a scene is rehearsed.
struct RehearsalOptions {
  /// A larger 99.9th percentile of a tick's CPU time is refused.
  double most_of_period = kMostOfPeriod;
  int attempts = 3;                 ///< CPU time is noisy: the best counts
  std::function<bool()> cancelled;  ///< asked before every tick; may be null
};

/// What a rehearsal came to.
struct Rehearsal {
  TickSummary summary;    ///< of the best attempt; CPU time per tick and stage, contacts
  double limit_us = 0.0;  ///< what the 99.9th percentile was held to
  Stage slowest = Stage::kPhysicsStep;  ///< takes most of the slow ticks
  std::string heaviest;                 ///< the body most touched in them; empty: none was touched
  int heaviest_contacts = 0;            ///< at most at once, of that body
  int bodies = 0, bodies_touched = 0;
  int attempts = 0;
};

/// Runs the worst contacts of a scene against a simulated device on this machine, as fast as it
/// goes, in the calling thread: the palm against every body that the device brings the hand to
/// while all fingers close, and the back of the fingers. Allocates, warms caches and measures each
/// tick's CPU time per stage before anybody feels a force. Refused where the 99.9th percentile is
/// above half the period, with the stage that takes it and what to remove; where the world broke;
/// where it was cancelled.
/// It leaves nothing behind: the exercise, which the models share, is reset by the next arm().
/// Not real-time safe.
/// @param start where the session's hand begins
/// @pre no rig that uses these models' exercise is ticking
[[nodiscard]] Expected<Rehearsal> rehearse(const Models& models, const AxisPosition& start,
                                           const RigOptions& rig,
                                           const RehearsalOptions& options = {});

/// "61 µs CPU at the median, 143 p99.9, 180 at most (500 allowed), mostly physics_step; 23 contacts
/// with 7 of 9 bodies"
[[nodiscard]] std::string describe(const Rehearsal& rehearsal);

}  // namespace wholehand
