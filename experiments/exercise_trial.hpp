#pragma once

#include "assembly/rig.hpp"
#include "core/expected.hpp"
#include "experiments/exercise_phases.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

struct ExercisePlan {
  ModelFiles files;  ///< with exercise; level 1 is played
  std::uint64_t seed = 1;
  std::string record;  ///< HDF5 file; empty: none
  RigOptions rig;
};

/// The paper's Fig. 7: what a person felt who bumped into the dispenser, laid the hand on it,
/// squeezed it, let go and retrieved the hand.
struct ExerciseResult {
  bool completed = false;  ///< all phases found, the drink served within tolerance, nothing spilt
  std::vector<ExercisePhase> phases;  ///< empty where they were not found
  std::vector<ExerciseBump> bumps;
  std::vector<std::string> axis_names;
  std::vector<double> lever_arms_m;  ///< 0 where an axis has no tip
  AxisRatio phi_peak;
  std::vector<double> fading_s;  ///< time constant of Φ after the hardest bump, per axis; 0: none
  double alpha_max = 0.0;
  double wall_pull_max_n = 0.0;  ///< largest exercise effort in the closing direction, at the tip
  double wall_push_max_n = 0.0;  ///< largest against it
  double volume_error_l = 0.0;   ///< largest |in the glass + spilt + left - start|
  double asked_l = 0.0, tolerance_l = 0.0, poured_l = 0.0, spilt_l = 0.0;
  double squeeze_max_n = 0.0;
  bool faulted = false, interrupted = false;
  std::vector<ExerciseSample> samples;  ///< one a tick
};

/// Runs it on the simulated clock. Refused where the exercise has no dispensers, or the device no
/// fingers.
[[nodiscard]] Expected<ExerciseResult> runExercise(const ExercisePlan& plan);

}  // namespace wholehand
