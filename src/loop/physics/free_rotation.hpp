#pragma once

#include "loop/core/real_time.hpp"

#include <Eigen/Geometry>

namespace wholehand {

/// How a rigid body's principal axes are turned, and its spin, both in the world.
struct FreeRotation {
  Eigen::Quaterniond axes = Eigen::Quaterniond::Identity();
  Eigen::Vector3d spin_rad_s = Eigen::Vector3d::Zero();
};

/// Turns a body on which no torque acts. It keeps its angular momentum L = R I Rᵀ ω to rounding;
/// the turn follows the implicit midpoint rule, which is symmetric in time: its energy error is of
/// second order in the turn of a step and does not grow (Hairer, Lubich, Wanner, Geometric
/// Numerical Integration, VII.5). Real-time safe.
/// @param moments principal moments of inertia [kg·m²], > 0
[[nodiscard]] WHOLEHAND_RT FreeRotation turnFree(const FreeRotation& from,
                                                 const Eigen::Vector3d& moments,
                                                 double step_s) noexcept;

}  // namespace wholehand
