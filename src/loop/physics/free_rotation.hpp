#pragma once

#include "loop/core/real_time.hpp"

#include <Eigen/Geometry>

namespace wholehand {

/// Orientation of a rigid body's principal axes, and its angular velocity, both in the world.
struct FreeRotation {
  Eigen::Quaterniond axes = Eigen::Quaterniond::Identity();
  Eigen::Vector3d spin_rad_s = Eigen::Vector3d::Zero();
};

/// Rotates a body on which no torque acts. Its angular momentum L = R I Rᵀ ω is conserved to
/// rounding. The rotation follows the implicit midpoint rule, which is symmetric in time: its
/// energy error is of second order in the rotation per step and does not grow (Hairer, Lubich,
/// Wanner, Geometric Numerical Integration, VII.5). Real-time safe.
/// @param moments principal moments of inertia [kg·m²], > 0
[[nodiscard]] WHOLEHAND_RT FreeRotation turnFree(const FreeRotation& from,
                                                 const Eigen::Vector3d& moments,
                                                 double step_s) noexcept;

}  // namespace wholehand
