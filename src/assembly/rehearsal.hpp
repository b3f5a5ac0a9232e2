#pragma once

#include "assembly/models.hpp"
#include "assembly/rig.hpp"
#include "renderer/rehearsal_passed.hpp"
#include "telemetry/statistics.hpp"

#include <functional>
#include <optional>
#include <string>

namespace wholehand {

/// The share of a period that the 99.9th percentile of a tick's CPU time may take: half. A library
/// that was built unoptimised or with a sanitizer is for finding mistakes, and takes what it takes.
[[nodiscard]] double mostOfPeriod() noexcept;

/// How a scene is rehearsed.
struct RehearsalOptions {
  /// A larger 99.9th percentile of a tick's CPU time is refused. More than mostOfPeriod() is for
  /// finding out: nothing is armed with such a rehearsal.
  double most_of_period = mostOfPeriod();
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
  std::optional<RehearsalPassed> passed;  ///< what arm() asks for
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
