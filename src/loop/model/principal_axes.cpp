#include "loop/model/principal_axes.hpp"

#include <Eigen/Eigenvalues>

namespace wholehand {

PrincipalAxes principalAxesOf(const Eigen::Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
  return {solver.eigenvectors(), solver.eigenvalues()};
}

}  // namespace wholehand
