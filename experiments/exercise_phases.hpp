#pragma once

#include "loop/core/axis_array.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Data of a tick for phases and figure. Contact forces are normal forces between hand and
/// dispenser.
struct ExerciseSample {
  double time_s = 0.0;
  AxisEffort sent;
  AxisEffort wall;  ///< f_e, the exercise's share of it
  AxisRatio phi;
  double alpha = 0.0;
  double dorsal_n = 0.0;   ///< on the back of the fingers
  double fingers_n = 0.0;  ///< on the four fingers, all sides
  double thumb_n = 0.0;
  double palm_n = 0.0;
  double palm_m = 0.0;  ///< distance from palm to dispenser
  double squeeze_n = 0.0, flow_l_s = 0.0, glass_l = 0.0;
};

struct ExercisePhase {
  std::string name;
  double start_s = 0.0, end_s = 0.0;
};

/// The four phases of the paper's Fig. 7 as the data show them: 1 bump: from the first to the last
/// touch with the back of the fingers, before the approach; 2 approach: from where the palm comes
/// near until the fingers close on the dispenser, α rising; 3 squeeze: from the touch of the
/// fingers that leads to a flow until it flows no more; 4 release: from there until nothing touches
/// and α is zero again. Empty when a phase is missing.
[[nodiscard]] std::optional<std::array<ExercisePhase, 4>> findPhases(
    const std::vector<ExerciseSample>& samples);

/// A contact with the back of the fingers.
struct ExerciseBump {
  double start_s = 0.0, end_s = 0.0;
  double contact_n = 0.0;  ///< largest
};
/// Bumps of the first phase; contacts less than 0.2 s apart are one.
[[nodiscard]] std::vector<ExerciseBump> findBumps(const std::vector<ExerciseSample>& samples,
                                                  const ExercisePhase& phase);

/// Time constant of an axis's Φ after the hardest bump, fitted from the end of contact until Φ
/// rises again [s]; 0 when it never decays for 0.1 s.
[[nodiscard]] double fadingTime_s(const std::vector<ExerciseSample>& samples,
                                  const std::vector<ExerciseBump>& bumps, int axis);

}  // namespace wholehand
