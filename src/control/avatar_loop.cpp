#include "control/avatar_loop.hpp"

#include "control/certificate/gain_search.hpp"
#include "control/coupling_gains.hpp"
#include "control/stability.hpp"

#include <Eigen/Cholesky>

#include <limits>

namespace wholehand {

Eigen::MatrixXd avatarLoopMatrix(const AxisMatrix& reduced_inertia, const AxisStiffness& k_pm,
                                 double period_s) {
  const Eigen::Index n = reduced_inertia.rows();
  const Eigen::MatrixXd m = reduced_inertia;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(m);
  if (cholesky.info() != Eigen::Success) {  // singular: such a hand has no valid dynamics
    return Eigen::MatrixXd::Constant(2 * n, 2 * n, std::numeric_limits<double>::infinity());
  }
  const Eigen::MatrixXd inverse = cholesky.solve(Eigen::MatrixXd::Identity(n, n));
  const AxisDamping damping = avatarDamping(reduced_inertia, k_pm, period_s);
  Eigen::MatrixXd out = Eigen::MatrixXd::Identity(2 * n, 2 * n);
  auto velocity = out.bottomRows(n);
  velocity.leftCols(n) = -period_s * inverse * k_pm.vec().asDiagonal();
  velocity.rightCols(n) -= period_s * inverse * damping.vec().asDiagonal();
  out.topRows(n) += period_s * velocity;
  return out;
}

WorstPosture worstPosture(const std::vector<AxisMatrix>& inertias, const AxisStiffness& k_pm,
                          double period_s) {
  WorstPosture worst;
  for (std::size_t p = 0; p < inertias.size(); ++p) {
    const double radius = spectralRadius(avatarLoopMatrix(inertias[p], k_pm, period_s));
    if (!(radius <= worst.radius)) worst = {radius, p};
  }
  return worst;
}

double largestStableFactor(const std::vector<AxisMatrix>& inertias, const AxisStiffness& k_pm,
                           double period_s, double most) {
  const auto times = [&k_pm](double factor) {
    AxisStiffness out = k_pm;
    out.vec() *= factor;
    return out;
  };
  // Bisects in the worst posture only, then checks all postures again. Searching all at once would
  // take seconds.
  double factor = most;
  WorstPosture worst = worstPosture(inertias, times(factor), period_s);
  // Each round finds another worst posture.
  for (std::size_t i = 0; i < inertias.size() && factor > 0.0 && worst.radius >= 1.0; ++i) {
    factor = roundedDown(largestAllowed(factor, [&](double f) {
      return spectralRadius(avatarLoopMatrix(inertias[worst.posture], times(f), period_s)) < 1.0;
    }));
    worst = worstPosture(inertias, times(factor), period_s);
  }
  return worst.radius < 1.0 ? factor : 0.0;
}

}  // namespace wholehand
