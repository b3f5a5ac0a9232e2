#pragma once

#include <Eigen/Core>

namespace wholehand {

/// e^m of a square matrix, by Eigen's scaling and squaring with Padé approximants. It stands alone
/// because that header takes a compiler longer than any source that needs it. Allocates.
[[nodiscard]] Eigen::MatrixXd matrixExponential(const Eigen::MatrixXd& m);

}  // namespace wholehand
