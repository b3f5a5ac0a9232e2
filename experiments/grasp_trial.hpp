#pragma once

#include "loop/core/expected.hpp"
#include "rig/rig.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// One grasp of the paper's Fig. 5: the object's position in the palm's frame when the hand closes,
/// and the person's commands. Palm frame: x distal, y radial, z dorsal.
struct GraspTrial {
  std::string shape;     ///< "cube", "sphere", "cylinder", "disk"
  std::string grasp;     ///< "power", "pinch"
  bool gravity = false;  ///< false: the object floats freely with the paper's damping of 0.7
  Eigen::Vector3d center_m{0, 0, 0};  ///< object's centre in the palm's frame
  double circumduction_rad = 0.0;     ///< circumduction of the thumb before closing
  double fingers_open_rad = 0.35, fingers_closed_rad = 0.0;  ///< commanded
  double thumb_closed_rad = 0.0;                             ///< commanded
  double friction = 0.8;                                     ///< friction of hand and object
  double size = 1.0;                                         ///< factor on the object's lengths
  /// Rotation of the whole trial in the world: object, gravity and the hand's paths. The device's
  /// mount rotates equally.
  Eigen::Vector3d turn_rpy_rad{0, 0, 0};

  [[nodiscard]] std::string name() const;
  /// The name without spaces, used for the trial's files.
  [[nodiscard]] std::string stem() const;
};

/// Result of one grasp.
struct GraspResult {
  GraspTrial trial;
  bool dropped = false;
  double carry_shift_m = 0.0;  ///< largest shift of the object's centre in the palm's frame, from
                               ///< the start of the lift
  double slip_m = 0.0;         ///< shift during the hold only; the rotation is in rotation_rad
  double rotation_rad = 0.0;   ///< rotation in the palm's frame during the hold
  double coupling_error_rad = 0.0;  ///< largest error before correction in the whole trial
  double object_travel_m = 0.0;     ///< carried distance
  double force_noise_n = 0.0;       ///< rms about the mean over the last 2 s, worst axis, tips in N
  double contact_residual = 0.0;  ///< |Σ Jᵀ f + f_s| at rest, means over the last 2 s, worst axis,
                                  ///< as a share of the largest of |f_s|, a tenth of the largest
                                  ///< f_s in the same unit, 0.1 N or 0.01 N·m
  double felt_error = 0.0;       ///< |Σ Jᵀ f − f_coupling|, relative as contact_residual, of
                                 ///< f_coupling
  double contact_force_n = 0.0;  ///< sum of |f| at the end
  double tip_force_max_n = 0.0;  ///< largest effort sent, hand axes, at the tip
  std::uint64_t saturated_ticks = 0;  ///< ticks with an effort at its limit
  double cpu_p50_us = 0.0, cpu_p999_us = 0.0;
  bool faulted = false;      ///< stopped by a fault; also counts as dropped
  bool interrupted = false;  ///< interrupted by Ctrl-C: the results are partial
};

/// The tuned trials: four shapes by power grasp, cube and sphere by pinch, each with and without
/// gravity.
[[nodiscard]] std::vector<GraspTrial> tunedTrials();

/// The tuned trials with jittered positions (±3 mm) and commands (±4° circumduction, ±6° others);
/// deterministic for a seed.
[[nodiscard]] std::vector<GraspTrial> jitteredTrials(int count, std::uint64_t seed);

/// Settings for running a trial.
struct TrialSetup {
  std::string folder;  ///< folder for the scene file and, if requested, the recording
  RigOptions rig;
  std::function<void(Models& models)> adjust = {};  ///< changes the models before the rig is built
};

/// Writes the trial's scene into the folder, loads the models with it and adjusts them. A recording
/// then contains everything needed to repeat the trial.
[[nodiscard]] Expected<Models> loadTrial(const GraspTrial& trial, ModelFiles files,
                                         const TrialSetup& setup);

struct GraspPlan {
  TrialSetup setup;
  bool record = false;
  double hold_s = 10.0;
};

/// Runs a trial through device, patient and renderer on the simulated clock: approach, close, carry
/// 20 cm, hold.
[[nodiscard]] Expected<GraspResult> runGrasp(const GraspTrial& trial, const ModelFiles& files,
                                             const GraspPlan& plan);

}  // namespace wholehand
