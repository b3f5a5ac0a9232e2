#pragma once

#include "core/axis_array.hpp"

#include <cstddef>
#include <vector>

namespace wholehand {

/// Closed-loop matrix over [q_s, q̇_s] of the avatar alone, its axes coupled by inertia, target at
/// rest: q̈_s = −M_r⁻¹ (K_pm q_s + D q̇_s) under symplectic Euler, D by avatarDamping(). The loop
/// is stable where 4 M_r − 2 T D − T² K_pm is positive definite. The matrix is infinite where the
/// inertia is not positive definite.
/// @param reduced_inertia armature included
[[nodiscard]] Eigen::MatrixXd avatarLoopMatrix(const AxisMatrix& reduced_inertia,
                                               const AxisStiffness& k_pm, double period_s);

/// The posture with the largest spectral radius of the avatar's loop.
struct WorstPosture {
  double radius = 0.0;  ///< spectral radius of the loop
  std::size_t posture = 0;
};
[[nodiscard]] WorstPosture worstPosture(const std::vector<AxisMatrix>& inertias,
                                        const AxisStiffness& k_pm, double period_s);

/// Largest common factor on K_pm, at most `most`, that is stable (radius < 1) in every posture; 0
/// when there is none. Rounded down to three digits unless it is `most` itself.
[[nodiscard]] double largestStableFactor(const std::vector<AxisMatrix>& inertias,
                                         const AxisStiffness& k_pm, double period_s,
                                         double most = 1.0);

}  // namespace wholehand
