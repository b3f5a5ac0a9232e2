#pragma once

#include "exercise/cocktail_bar/bar.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// The figures of the bar in ExerciseRecord::values; after these left_l/<liquid> of each dispenser
/// and layer_l/<step>.
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
                      "resume_drink"};

/// Names of all values of a bar, in the order of ExerciseRecord::values.
[[nodiscard]] std::vector<std::string> barValueNames(const Bar& bar);

/// What the page needs to know of a bar (docs/exercises.md).
[[nodiscard]] std::string barJson(const Bar& bar);

}  // namespace wholehand
