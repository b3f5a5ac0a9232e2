#pragma once

#include "experiments/exercise_phases.hpp"
#include "loop/core/expected.hpp"
#include "rig/rig.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

struct ExercisePlan {
  ModelFiles files;  ///< with exercise; plays level 1
  std::uint64_t seed = 1;
  std::string record;  ///< HDF5 file; empty: none
  RigOptions rig;
};

/// Result of the paper's Fig. 7: felt efforts while bumping into the dispenser, laying the hand on
/// it, squeezing, releasing and retracting.
struct ExerciseResult {
  bool completed = false;  ///< all phases found, the drink served within tolerance, nothing spilt
  std::vector<ExercisePhase> phases;  ///< empty when not found
  std::vector<ExerciseBump> bumps;
  std::vector<std::string> axis_names;
  std::vector<double> lever_arms_m;  ///< per axis; 0: no tip
  AxisRatio phi_peak;
  std::vector<double> fading_s;  ///< per axis: time constant of Φ after the hardest bump; 0: none
  double alpha_max = 0.0;
  double wall_pull_max_n = 0.0;  ///< largest exercise effort in the closing direction, at the tip
  double wall_push_max_n = 0.0;  ///< largest in the opening direction
  double volume_error_l = 0.0;   ///< largest |in the glass + spilt + left - start|
  double asked_l = 0.0, tolerance_l = 0.0, poured_l = 0.0, spilt_l = 0.0;
  double squeeze_max_n = 0.0;
  bool faulted = false, interrupted = false;
  std::vector<ExerciseSample> samples;  ///< one per tick
};

/// Runs the trial on the simulated clock. Refused for an exercise without dispensers or a device
/// without fingers.
[[nodiscard]] Expected<ExerciseResult> runExercise(const ExercisePlan& plan);

}  // namespace wholehand
