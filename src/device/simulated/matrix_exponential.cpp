#include "device/simulated/matrix_exponential.hpp"

#include <unsupported/Eigen/MatrixFunctions>

namespace wholehand {

Eigen::MatrixXd matrixExponential(const Eigen::MatrixXd& m) {
  return m.exp();
}

}  // namespace wholehand
