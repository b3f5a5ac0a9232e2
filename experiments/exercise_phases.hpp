#pragma once

#include "loop/core/axis_array.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Data of a tick for the phases and the figure. Contact forces are normal forces between hand and
/// dispenser.
struct ExerciseSample {
  double time_s = 0.0;
  AxisEffort sent;
  AxisEffort wall;  ///< f_e, the exercise's share of `sent`
  AxisRatio phi;
  double alpha = 0.0;
  double dorsal_n = 0.0;   ///< force on the back of the fingers
  double fingers_n = 0.0;  ///< force on all sides of the four fingers
  double thumb_n = 0.0;
  double palm_n = 0.0;
  double palm_m = 0.0;  ///< distance from palm to dispenser
  double squeeze_n = 0.0, flow_l_s = 0.0, glass_l = 0.0;
};

struct ExercisePhase {
  std::string name;
  double start_s = 0.0, end_s = 0.0;
};

/// Finds the four phases of the paper's Fig. 7 in the data. 1 bump: from the first to the last
/// touch with the back of the fingers before the approach. 2 approach: from the time at which the
/// palm comes near, with rising α, until the fingers close on the dispenser. 3 squeeze: from the
/// touch of the fingers that leads to a flow until the flow ends. 4 release: from then until
/// nothing touches and α is zero again. Empty when a phase is missing.
[[nodiscard]] std::optional<std::array<ExercisePhase, 4>> findPhases(
    const std::vector<ExerciseSample>& samples);

/// A contact with the back of the fingers.
struct ExerciseBump {
  double start_s = 0.0, end_s = 0.0;
  double contact_n = 0.0;  ///< largest contact force
};
/// Bumps of the first phase. Contacts less than 0.2 s apart count as one bump.
[[nodiscard]] std::vector<ExerciseBump> findBumps(const std::vector<ExerciseSample>& samples,
                                                  const ExercisePhase& phase);

/// Time constant of the decay of an axis's Φ after the hardest bump, fitted from the end of contact
/// until Φ rises again [s]; 0 when no decay lasts 0.1 s.
[[nodiscard]] double fadingTime_s(const std::vector<ExerciseSample>& samples,
                                  const std::vector<ExerciseBump>& bumps, int axis);

}  // namespace wholehand
