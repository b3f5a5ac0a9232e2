#pragma once

#include "core/exercise_record.hpp"
#include "core/real_time.hpp"

#include <array>
#include <cstdint>

namespace wholehand {

enum class BarEvent : std::int32_t {
  kApproached,      ///< palm near a dispenser; value: distance [m]
  kTouched,         ///< first contact with it
  kEngaged,         ///< its walls fade in
  kDisengaged,      ///< ... out
  kPourBegan,       ///< into the glass
  kPourEnded,       ///< value: what the step has by then [l]
  kLineReached,     ///< index: step
  kOverfilled,      ///< index: step; from now on what comes is spilt
  kSpilt,           ///< began to be spilt; value: spilt so far in the level [l]
  kWrongDispenser,  ///< engaged, though another one is asked for
  kKnockedOver,
  kStoodUp,
  kStepDone,   ///< index: step; value: what it has [l]
  kDrinkDone,  ///< index: drink; value: its score
  kLevelDone,  ///< value: the level's score
  kPaused,
  kResumed,
  kRestarted,
  kEmpty,  ///< a dispenser has nothing left
  kCount
};

/// The names of the events, in their order.
inline constexpr std::array<const char*, static_cast<std::size_t>(BarEvent::kCount)>
    kBarEventNames = {"approached",   "touched",      "engaged",    "disengaged", "pour_began",
                      "pour_ended",   "line_reached", "overfilled", "spilt",      "wrong_dispenser",
                      "knocked_over", "stood_up",     "step_done",  "drink_done", "level_done",
                      "paused",       "resumed",      "restarted",  "empty"};

/// Adds an event to the tick's; dropped when there are too many. Real-time safe.
WHOLEHAND_RT inline void addEvent(ExerciseRecord& out, BarEvent type, int index = -1,
                                  double value = 0.0) noexcept {
  if (out.event_count >= kMaxExerciseEvents) return;
  out.events[static_cast<std::size_t>(out.event_count++)] =
      ExerciseEvent{static_cast<std::int32_t>(type), index, value};
}

}  // namespace wholehand
