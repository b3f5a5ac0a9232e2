#pragma once

#include <Eigen/Core>

namespace wholehand {

/// Eigenvectors and eigenvalues of a symmetric matrix: principal axes and moments of an inertia.
struct PrincipalAxes {
  Eigen::Matrix3d axes;     ///< columns of unit length; left-handed or right-handed
  Eigen::Vector3d moments;  ///< ascending, in the unit of the matrix
};

/// Uses Eigen's solver, which is compiled here once because it takes the compiler seconds. Does not
/// allocate.
PrincipalAxes principalAxesOf(const Eigen::Matrix3d& symmetric);

}  // namespace wholehand
