#pragma once

#include "core/axis_array.hpp"

#include <cstddef>
#include <vector>

namespace wholehand {

/// The avatar alone, all axes coupled by its inertia, target at rest: matrix over [q_s, q̇_s] of
/// q̈_s = −M_r⁻¹ M̃_r (K_ps q_s + K_ds q̇_s) under symplectic Euler, K_ds by Eq. (14).
/// Infinite where the inertia is not positive definite.
[[nodiscard]] Eigen::MatrixXd avatarLoopMatrix(const AxisMatrix& reduced_inertia,
                                               const Eigen::VectorXd& k_ps_per_s2, double period_s);

/// The avatar in the posture that shakes most.
struct ShakingPosture {
  double radius = 0.0;  ///< spectral radius of its loop
  std::size_t posture = 0;
};
[[nodiscard]] ShakingPosture worstPosture(const std::vector<AxisMatrix>& inertias,
                                          const Eigen::VectorXd& k_ps_per_s2, double period_s);

/// Largest common factor on K_ps, at most `most`, that is stable (< 1) in every posture; 0 when
/// none is. Rounded down to three digits unless it is `most` itself.
[[nodiscard]] double allowedFactor(const std::vector<AxisMatrix>& inertias,
                                   const Eigen::VectorXd& k_ps_per_s2, double period_s,
                                   double most = 1.0);

}  // namespace wholehand
