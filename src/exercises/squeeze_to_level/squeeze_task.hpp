#pragma once

#include "exercises/finger_wall_file.hpp"
#include "loop/core/real_time.hpp"
#include "loop/exercise/finger_cushions.hpp"
#include "loop/exercise/finger_walls.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

namespace wholehand::squeeze_to_level {

/// A band of force to hold; both ends belong to it.
struct Band {
  double low_n = 0.0, high_n = 0.0;
};

struct BandRules {
  std::vector<Band> bands;
  double hold_s = 2.0;    ///< total time to hold in each band
  double let_go_n = 0.3;  ///< below this force the object counts as released
};

/// Current instruction: index of [[panel.instructions]].
enum class Instruction { kReach, kMore, kHold, kLess, kLetGo, kDone };

/// Changes in one tick.
struct BandChange {
  int held = -1;  ///< band completed in this tick; -1: none
  bool entered = false, done = false;
};

/// State machine of the bands: current band, time held, score. Pure; real-time safe.
class BandSteps {
 public:
  /// @pre rules outlives this and has a band
  explicit BandSteps(const BandRules& rules) : rules_(rules) {}

  void reset() noexcept;

  /// @param near the hand is at the object @param ratio factor on every band, > 0
  WHOLEHAND_RT BandChange tick(double squeeze_n, bool near, double ratio,
                               double elapsed_s) noexcept;

  [[nodiscard]] Instruction instruction() const noexcept { return instruction_; }
  [[nodiscard]] int band() const noexcept { return band_; }
  [[nodiscard]] int bandsDone() const noexcept { return bands_done_; }
  [[nodiscard]] double held_s() const noexcept { return held_s_; }
  [[nodiscard]] bool done() const noexcept { return instruction_ == Instruction::kDone; }
  /// The band to hold, scaled by `ratio`; 0 .. let_go_n while releasing or done [N].
  [[nodiscard]] WHOLEHAND_RT Band goal(double ratio) const noexcept;
  /// Score, 0 .. 100: mean over all bands of the share of time within the band, from first entering
  /// it until it was held. Bands not reached count 0.
  [[nodiscard]] WHOLEHAND_RT double score() const noexcept;

 private:
  [[nodiscard]] bool lettingGo() const noexcept { return instruction_ == Instruction::kLetGo; }
  BandChange hold(double squeeze_n, bool near, const Band& goal, double elapsed_s) noexcept;

  const BandRules& rules_;
  Instruction instruction_ = Instruction::kReach;
  int band_ = 0, bands_done_ = 0;
  double held_s_ = 0.0;
  double since_entered_s_ = -1.0;  ///< < 0: not entered yet
  double earned_ = 0.0;            ///< sum over the bands, each 0 .. 1
};

/// Data of the exercise, from its file and scene. Immutable during play.
struct SqueezeTask {
  std::string name;
  int body = -1;  ///< body to squeeze: index in the scene
  double radius_m = 0.0, height_m = 0.0, soft_m = 0.0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();  ///< of the body
  double filter_hz = 5.0;                              ///< low-pass of the squeeze
  BandRules rules;
  FingerWallFile wall;
  Bottle bottle;  ///< the squeezed object
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
