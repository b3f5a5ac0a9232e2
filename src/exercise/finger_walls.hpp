#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "model/hand_model.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// The walls of an exercise: one on each hand axis that has a stiffness here. Fingers close towards
/// larger coordinates.
struct FingerWallConfig {
  int axes = 0;
  AxisRatio lever_arm_m;     ///< of the axis; 1 where it has none
  AxisRatio stiffness;       ///< k of the softest target [N/m or N·m/rad]; 0: no wall on the axis
  AxisRatio damping;         ///< d of the thinnest target [N·s/m or N·m·s/rad]
  AxisEffort effort_cap;     ///< below the device's limit [N or N·m]
  double soft_m = 0.0;       ///< depth of the targets' soft sides
  double follow_m_s = 0.04;  ///< fastest that a wall moves while α > 0, at the tip
};

/// How much of the configured gains is wanted.
struct WallRatios {
  double stiffness = 1.0;
  double damping = 1.0;
};

struct FingerWallState {
  AxisPosition position;  ///< θ_wall
  AxisRatio known;        ///< 1: there is a wall
  AxisPosition finger;    ///< q_m of that tick
};

/// What the walls look at in a tick.
struct FingerSight {
  AxisPosition closure;        ///< first touch per axis; not finite where there is none
  AxisPosition q_m;            ///< device
  AxisPosition q_s;            ///< avatar
  std::uint32_t touching = 0;  ///< bit a: what axis a moves touches the target
  std::uint32_t inside = 0;    ///< bit a: it is in the target's soft side, and closing presses on
};

/// Per capsule of the hand: bit a where axis a moves it against the palm.
[[nodiscard]] std::vector<std::uint32_t> axesOfCapsules(const HandModel& hand);

/// Which axes move something that touches the body, as FingerSight::touching. Real-time safe.
/// @param axes_of_capsule as axesOfCapsules() gives it
[[nodiscard]] WHOLEHAND_RT std::uint32_t touchingAxes(
    const TickRecord& record, int body, const std::vector<std::uint32_t>& axes_of_capsule) noexcept;

/// Keeps each wall lead_in_m of fingertip path before the first touch that the world found, for
/// fingers that have this touch before them or press into the soft side behind it. A wall begins at
/// the target or, where the finger is past that, at the finger. From then on (α > 0) θ_wall is
/// continuous, but for a soft side's that nothing is in, which goes to the target at once:
/// - towards the closed hand it follows at follow_m_s, but gives way at once to a digit that
///   touches nothing: that digit's effort only falls;
/// - towards the open hand it follows at follow_m_s, but into the finger only while the digit
///   touches the target, and never while it is in a soft side: there the wall is a spring that
///   gives back what it took.
/// So a digit that touches nothing gets no effort but by its own closing on the lead-in. Where the
/// finger is past the touch or there is none, no wall begins, and one that is felt lets go; but it
/// stays where it is while the digit is pressed against the target that meets it at the open end
/// already (closure −∞): the first touch wavers there, and the effort would come and go.
/// Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT FingerWallState followClosure(const FingerWallState& state,
                                                         const FingerSight& seen, double lead_in_m,
                                                         double alpha,
                                                         const FingerWallConfig& config,
                                                         double elapsed_s) noexcept;

/// Eq. (15) and (17): f_e on every axis. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort fingerWallEffort(const FingerWallState& state,
                                                       const AxisPosition& q_m,
                                                       const AxisVelocity& qd_mf, double alpha,
                                                       const WallRatios& ratios,
                                                       const FingerWallConfig& config) noexcept;

}  // namespace wholehand
