#pragma once

#include "exercises/finger_wall_file.hpp"
#include "exercises/tell_apart/comparing.hpp"
#include "exercises/tell_apart/stimulus.hpp"
#include "loop/exercise/finger_cushions.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <iterator>
#include <string>

namespace wholehand::tell_apart {

/// A bottle of the scene: a fixed upright cylinder.
struct BottleBody {
  int body = -1;  ///< index in the scene
  double radius_m = 0.0, height_m = 0.0, soft_m = 0.0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
};

/// Data of the exercise, from its file and scene. Immutable during play.
struct TellApartTask {
  std::string name;
  QuantityLaw law = kLaws[0];
  std::array<BottleBody, kBottles> bottles;  ///< in the order in which they are squeezed
  double filter_hz = 5.0;                    ///< low-pass of the squeeze
  double let_go_n = 0.3;                     ///< below this force nothing is squeezed
  double depth_m = 0.006;                    ///< mean depth of a squeeze, from the start on
  bool says_right = false;                   ///< an event says whether an answer was right
  ComparingRules rules;
  FingerWallFile wall;
  Bottle bottle;
  Stimulus least;  ///< the stimulus with the least of the quantity

  /// The stimulus with e^amount of the quantity. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Stimulus with(double amount) const noexcept {
    Stimulus out = least;
    law.apply(std::exp(amount), out);
    return out;
  }
};

/// Indices of ExerciseRecord::values; kValueNames are their names.
/// loop/psychometrics/answer_log.hpp reads x, other, is_catch, said_second and said_by.
enum Value : std::int32_t {
  kInstruction,
  kDone,
  kPaused,
  kAnswers,
  kAsked,
  kTime,
  kWanted,  ///< bottle to be squeezed; -1: none, or the person's choice
  kAnswering,
  kAt,  ///< bottle that is felt; -1: none
  kPressed,
  kPressedLow,
  kPressedHigh,
  kSqueeze,
  kX,  ///< of the comparison under way; in the tick of the event "answered", of that one
  kOther,
  kIsCatch,
  kSaidSecond,  ///< of the last answer
  kSaidBy,
  kAmount,  ///< ln of what the felt bottle has of the quantity, over the least
  kStart,   ///< depth at which it begins to resist
  kDepth,   ///< asked depth from there
  kLeastX,  ///< least and largest |x| that is offered
  kMostX,
  kPlace,
  kValues
};
inline constexpr const char* kValueNames[] = {
    "instruction", "done",      "paused",  "answers",  "asked",       "time_s",
    "wanted",      "answering", "at",      "pressed",  "pressed_low", "pressed_high",
    "squeeze_n",   "x",         "other",   "is_catch", "said_second", "said_by",
    "amount",      "start_m",   "depth_m", "least_x",  "most_x",      "place"};
static_assert(std::size(kValueNames) == kValues);

}  // namespace wholehand::tell_apart
