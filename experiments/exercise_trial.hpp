#pragma once

#include "experiments/exercise_phases.hpp"
#include "loop/core/expected.hpp"
#include "rig/rig.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

struct ExercisePlan {
  ModelFiles files;  ///< files including an exercise; level 1 is played
  std::uint64_t seed = 1;
  std::string record;  ///< HDF5 file; empty: none
  RigOptions rig;
};

/// Result of the paper's Fig. 7: rendered efforts while the hand bumps into the dispenser, is laid
/// on it, squeezes, releases and retracts.
struct ExerciseResult {
  /// All phases were found, the drink was served within tolerance, nothing was spilt.
  bool completed = false;
  std::vector<ExercisePhase> phases;  ///< empty when not found
  std::vector<ExerciseBump> bumps;
  std::vector<std::string> axis_names;
  std::vector<double> lever_arms_m;  ///< per axis; 0: no tip
  AxisRatio phi_peak;
  std::vector<double> fading_s;  ///< per axis: time constant of Φ after the hardest bump; 0: none
  double alpha_max = 0.0;
  double wall_pull_max_n = 0.0;  ///< largest exercise effort in the closing direction, at the tip
  double wall_push_max_n = 0.0;  ///< largest exercise effort in the opening direction, at the tip
  double volume_error_l = 0.0;   ///< largest |in the glass + spilt + left - initial volume|
  double asked_l = 0.0, tolerance_l = 0.0, poured_l = 0.0, spilt_l = 0.0;
  double squeeze_max_n = 0.0;
  bool faulted = false, interrupted = false;
  std::vector<ExerciseSample> samples;  ///< one per tick
};

/// Runs the trial on the simulated clock. Returns an error for an exercise without dispensers or a
/// device without fingers.
[[nodiscard]] Expected<ExerciseResult> runExercise(const ExercisePlan& plan);

}  // namespace wholehand
