#include "dynamics/synergy.hpp"

#include <Eigen/Cholesky>

namespace wholehand {

Synergy::Synergy(const HandModel& hand)
    : theta0_(hand.theta0), joints_(hand.joint_count), axes_(hand.axis_count) {
  const Eigen::MatrixXd g = hand.synergy;
  const Eigen::MatrixXd inverse = (g.transpose() * g).ldlt().solve(g.transpose());
  for (int j = 0; j < joints_; ++j) {
    for (int a = 0; a < axes_; ++a) {
      if (g(j, a) != 0.0) forward_[forward_count_++] = {j, a, g(j, a)};
      if (inverse(a, j) != 0.0) back_[back_count_++] = {j, a, inverse(a, j)};
    }
  }
}

}  // namespace wholehand
