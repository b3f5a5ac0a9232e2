#pragma once

#include "exercise/finger_cushions.hpp"
#include "exercise/finger_walls.hpp"
#include "exercise/squeeze_to_level/band_steps.hpp"
#include "model/scene/scene_model.hpp"

#include <cstdint>
#include <iterator>
#include <string>

namespace wholehand::squeeze_to_level {

/// Data of the exercise, from its file and scene. Immutable during play.
struct SqueezeTask {
  std::string name;
  int body = -1;  ///< body to squeeze: index in the scene
  double radius_m = 0.0, height_m = 0.0, soft_m = 0.0;
  double filter_hz = 5.0;  ///< low-pass of the squeeze
  BandRules rules;
  FingerWallFile wall;
  Bottle bottle;  ///< what is squeezed
};

/// Indices of ExerciseRecord::values; kValueNames are their names.
enum Value : std::int32_t {
  kInstruction,
  kScore,
  kDone,
  kBandsDone,
  kBands,
  kSqueeze,
  kGoalLow,
  kGoalHigh,
  kHeld,
  kFlow,
  kPaused,
  kValues
};
inline constexpr const char* kValueNames[] = {
    "instruction", "score",       "done",   "bands_done", "bands", "squeeze_n",
    "goal_low_n",  "goal_high_n", "held_s", "flow_ml_s",  "paused"};
static_assert(std::size(kValueNames) == kValues);

}  // namespace wholehand::squeeze_to_level
