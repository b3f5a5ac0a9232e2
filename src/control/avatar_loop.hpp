#pragma once

#include "core/axis_array.hpp"

#include <cstddef>
#include <vector>

namespace wholehand {

/// The avatar alone, all axes coupled by its inertia, target at rest: matrix over [q_s, q̇_s] of
/// q̈_s = −M_r⁻¹ (K_pm q_s + D q̇_s) under symplectic Euler, D by avatarDamping().
/// It is stable where 4 M_r − 2 T D − T² K_pm is positive definite.
/// Infinite where the inertia is not positive definite.
/// @param reduced_inertia armature included
[[nodiscard]] Eigen::MatrixXd avatarLoopMatrix(const AxisMatrix& reduced_inertia,
                                               const AxisRatio& k_pm, double period_s);

/// The avatar in the posture that shakes most, or comes to rest most slowly.
struct ShakingPosture {
  double radius = 0.0;  ///< spectral radius of its loop
  std::size_t posture = 0;
};
[[nodiscard]] ShakingPosture worstPosture(const std::vector<AxisMatrix>& inertias,
                                          const AxisRatio& k_pm, double period_s);

/// Largest common factor on K_pm, at most `most`, that is stable (< 1) in every posture; 0 when
/// none is. Rounded down to three digits unless it is `most` itself.
[[nodiscard]] double allowedFactor(const std::vector<AxisMatrix>& inertias, const AxisRatio& k_pm,
                                   double period_s, double most = 1.0);

}  // namespace wholehand
