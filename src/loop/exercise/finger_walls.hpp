#pragma once

#include "loop/control/transition.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/exercise/exercise.hpp"
#include "loop/model/device_model.hpp"

#include <cstdint>

namespace wholehand {

/// Walls of an exercise: one wall on each hand axis whose stiffness here is > 0. Fingers close
/// towards larger coordinates.
struct FingerWallConfig {
  int axes = 0;
  AxisLength lever_arm_m;    ///< lever arm of the axis; 1 without one
  AxisStiffness stiffness;   ///< stiffness k of the targets' shells; 0: no wall on the axis
  AxisEffort effort_cap;     ///< below the device's limit [N or N·m]
  double soft_m = 0.0;       ///< depth of the targets' soft shells
  double follow_m_s = 0.04;  ///< largest speed of a wall while α > 0, at the tip
};

struct FingerWallState {
  AxisPosition position;  ///< θ_wall
  AxisFlag known;         ///< the axis has a wall
  AxisPosition finger;    ///< device position q_m at that tick
};

/// Input of the walls in a tick.
struct FingerWallInput {
  AxisPosition closure;        ///< first touch per axis; not finite without one
  AxisPosition q_m;            ///< device position
  AxisPosition q_s;            ///< avatar position
  std::uint32_t touching = 0;  ///< bit a: a link moved by axis a touches the target
  /// Bit a: axis a is in the target's soft shell, and closing presses it deeper.
  std::uint32_t inside = 0;
};

/// Updates the walls. The target of each wall lies lead_in_m of fingertip path before the first
/// touch. It exists for fingers that have not reached this touch or that press into the soft shell
/// behind it. A new wall begins at its target or, if the finger is past that, at the finger. From
/// then on (α > 0) θ_wall is continuous, except for the wall of a soft shell with no finger in it,
/// which jumps to its target:
/// - towards the closed hand it moves at follow_m_s. It yields at once to a digit without contact,
///   whose effort can therefore only fall;
/// - towards the open hand it moves at follow_m_s. It moves into the finger only while the digit
///   touches the target, and never while the digit is in a soft shell: there the wall is a spring
///   that returns the energy it stored.
/// A digit without contact is thus loaded only by closing onto the lead-in itself. A finger past
/// the touch, or without one, gets no new wall, and releases one that it feels. The wall stays
/// fixed while the digit is pressed against a target that touches it at the open end (closure −∞).
/// The first touch is unsteady there, and the effort would come and go. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT FingerWallState followClosure(const FingerWallState& state,
                                                         const FingerWallInput& seen,
                                                         double lead_in_m, double alpha,
                                                         const FingerWallConfig& config,
                                                         double elapsed_s) noexcept;

/// Upper ends of the live parameters for the walls' stiffness and their lead-in. The certificate
/// covers the walls at this ratio.
inline constexpr double kLargestWallRatio = 1.2;
inline constexpr double kLargestLeadIn_m = 0.02;

}  // namespace wholehand
