#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// The walls of an exercise: one on each hand axis that has a stiffness here. Fingers close towards
/// larger coordinates.
struct FingerWallConfig {
  int axes = 0;
  AxisRatio lever_arm_m;     ///< of the axis; 1 where it has none
  AxisRatio stiffness;       ///< k of the softest target [N/m or N·m/rad]; 0: no wall on the axis
  AxisRatio damping;         ///< d of the thinnest target [N·s/m or N·m·s/rad]
  AxisEffort effort_cap;     ///< below the device's limit [N or N·m]
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
};

/// Keeps each wall lead_in_m of fingertip path before the first touch that the world found.
/// θ_wall is continuous while it may be felt (α > 0): it follows at follow_m_s, a NaN closure
/// leaves it where it is, and one that appears late begins at the finger. At α = 0 it is where it
/// belongs at once, and gone when the closure is. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT FingerWallState followClosure(
    const FingerWallState& state, const AxisPosition& closure, const AxisPosition& q_m,
    double lead_in_m, double alpha, const FingerWallConfig& config, double elapsed_s) noexcept;

/// Eq. (15) and (17): f_e on every axis. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort fingerWallEffort(const FingerWallState& state,
                                                       const AxisPosition& q_m,
                                                       const AxisVelocity& qd_mf, double alpha,
                                                       const WallRatios& ratios,
                                                       const FingerWallConfig& config) noexcept;

}  // namespace wholehand
