#pragma once

#include "core/axis_array.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// A tick of the exercise, as far as its phases and its figure need it. Contact forces are normal
/// forces between the hand and the dispenser.
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
  double palm_m = 0.0;  ///< palm to the dispenser
  double squeeze_n = 0.0, flow_l_s = 0.0, glass_l = 0.0;
};

struct ExercisePhase {
  std::string name;
  double start_s = 0.0, end_s = 0.0;
};

/// The four phases of the paper's Fig. 7 as the data show them:
/// 1 bump: from the first to the last touch with the back of the fingers, before the approach;
/// 2 approach: from where the palm comes near until the fingers close on the dispenser, α rising;
/// 3 squeeze: from the touch of the fingers that leads to a flow until it flows no more;
/// 4 release: from there until nothing touches and α is zero again.
/// None where one of them is not in the data.
[[nodiscard]] std::optional<std::array<ExercisePhase, 4>> findPhases(
    const std::vector<ExerciseSample>& samples);

/// A touch with the back of the fingers.
struct ExerciseBump {
  double start_s = 0.0, end_s = 0.0;
  double contact_n = 0.0;  ///< largest
};
/// Those of the first phase; touches less than 0.2 s apart are one.
[[nodiscard]] std::vector<ExerciseBump> findBumps(const std::vector<ExerciseSample>& samples,
                                                  const ExercisePhase& phase);

/// The time constant with which Φ of an axis fades after the hardest bump, from the touch's end
/// until it rises again; 0 where it never fades for 0.1 s. [s]
[[nodiscard]] double fadingTime_s(const std::vector<ExerciseSample>& samples,
                                  const std::vector<ExerciseBump>& bumps, int axis);

}  // namespace wholehand
