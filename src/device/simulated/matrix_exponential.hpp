#pragma once

#include <Eigen/Core>

namespace wholehand {

/// e^m of a square matrix, by Eigen's scaling and squaring with Padé approximants. In a file of its
/// own because that header is slow to compile. Allocates.
[[nodiscard]] Eigen::MatrixXd matrixExponential(const Eigen::MatrixXd& m);

}  // namespace wholehand
