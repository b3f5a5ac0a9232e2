#pragma once

#include "exercises/cocktail_bar/bar.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/exercise/exercise.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// Values and events of the bar in a tick's ExerciseRecord, and functions that read them.
namespace wholehand {

/// Current instruction to the person; the numbers are those of the value "stage".
enum class BarStage : std::int32_t {
  kReach,
  kSqueeze,
  kPouring,
  kLetGo,
  kDrinkDone,
  kLevelDone,
  kDrawBack,
  kBreathe  ///< the stroke is spent: the person lets go until air has refilled the shell
};

/// Events of the bar.
enum class BarEvent : std::int32_t {
  kApproached,      ///< palm near a dispenser; value: distance [m]
  kTouched,         ///< first contact with a dispenser
  kEngaged,         ///< walls fade in
  kDisengaged,      ///< walls fade out
  kPourBegan,       ///< flow into the glass begins
  kPourEnded,       ///< value: volume of the step so far [l]
  kLineReached,     ///< index: step
  kOverfilled,      ///< index: step; further flow counts as spilt
  kSpilt,           ///< spilling begins; value: total spilt in the level [l]
  kWrongDispenser,  ///< engaged a dispenser that is not the target
  kKnockedOver,
  kStoodUp,
  kStepDone,   ///< index: step; value: its volume [l]
  kDrinkDone,  ///< index: drink; value: its score
  kLevelDone,  ///< value: the level's score
  kPaused,
  kResumed,
  kRestarted,
  kEmpty,  ///< a dispenser is empty
  kCount
};

/// Names of the events, in order.
inline constexpr std::array<const char*, static_cast<std::size_t>(BarEvent::kCount)>
    kBarEventNames = {"approached",   "touched",      "engaged",    "disengaged", "pour_began",
                      "pour_ended",   "line_reached", "overfilled", "spilt",      "wrong_dispenser",
                      "knocked_over", "stood_up",     "step_done",  "drink_done", "level_done",
                      "paused",       "resumed",      "restarted",  "empty"};

/// Adds an event to the record; dropped when it is full. Real-time safe.
WHOLEHAND_RT inline void addEvent(ExerciseRecord& out, BarEvent type, int index = -1,
                                  double value = 0.0) noexcept {
  addEvent(out, static_cast<std::int32_t>(type), index, value);
}

/// Values of the bar in ExerciseRecord::values. They are followed by left_l/<liquid> of each
/// dispenser and layer_l/<step>.
enum class BarValue : std::int32_t {
  kStage,
  kDrink,
  kDrinks,
  kStep,
  kSteps,
  kTargetDispenser,
  kEngagedDispenser,
  kSqueeze,
  kSqueezeLow,
  kSqueezeHigh,
  kSqueezeFull,
  kFlow,
  kOverGlass,
  kPoured,
  kAsked,
  kTolerance,
  kGlass,
  kSpilt,
  kScore,
  kStars,
  kDrinkTime,
  kRowY,
  kSqueezeThreshold,
  kPouredTotal,
  kStartTotal,
  kRestLeft,
  kPaused,
  kPalmDispenser,
  kResumeDrink,
  kPressed,
  kCount
};

inline constexpr std::array<const char*, static_cast<std::size_t>(BarValue::kCount)>
    kBarValueNames = {"stage",
                      "drink",
                      "drinks",
                      "step",
                      "steps",
                      "target_dispenser",
                      "engaged_dispenser",
                      "squeeze_n",
                      "squeeze_low_n",
                      "squeeze_high_n",
                      "squeeze_full_n",
                      "flow_l_s",
                      "over_glass",
                      "poured_l",
                      "asked_l",
                      "tolerance_l",
                      "glass_l",
                      "spilt_l",
                      "score",
                      "stars",
                      "drink_time_s",
                      "row_y_m",
                      "squeeze_threshold_n",
                      "poured_total_l",
                      "start_total_l",
                      "rest_left_s",
                      "paused",
                      "palm_dispenser",
                      "resume_drink",
                      "pressed_l"};

/// Names of all values of a bar, in the order of ExerciseRecord::values.
[[nodiscard]] std::vector<std::string> barValueNames(const Bar& bar);

/// Progress of the play, read from a record.
struct BarStatus {
  BarStage stage = BarStage::kReach;
  int drink = 0, step = 0, target = -1, engaged = -1;
  double squeeze_n = 0.0, low_n = 0.0, high_n = 0.0;
  double flow_l_s = 0.0, poured_l = 0.0, asked_l = 0.0;
};
[[nodiscard]] WHOLEHAND_RT BarStatus readBarStatus(const ExerciseRecord& record) noexcept;

/// Description of a bar for the page (docs/exercises.md).
[[nodiscard]] std::string barJson(const Bar& bar);

}  // namespace wholehand
