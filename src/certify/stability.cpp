#include "certify/stability.hpp"

#include "loop/control/bilateral_coupling.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <limits>

namespace wholehand {
namespace {

/// Indices of the state of the sampled loop. The efforts in transit to the device follow from
/// kFirstEffort on, oldest first.
enum Index : int { kXm, kVm, kXmPrevious, kVf, kXs, kVs, kFirstEffort };

/// Exact zero-order-hold solution of m ẍ = f − b ẋ − k x over one period:
/// x += travel v + push_x f − fall_x x, v = keep v + push_v f − fall_v x.
struct HeldDevice {
  double travel_s, keep, push_x, push_v;
  double fall_x = 0.0, fall_v = 0.0;
};

HeldDevice holdWithoutSpring(double mass, double damping, double period_s) {
  const double rate_per_s = damping / mass;
  const double decay = rate_per_s * period_s;
  if (decay < 1e-5) {  // uses the series, because the closed form cancels
    const double travel_s = period_s * (1.0 - decay / 2.0 + decay * decay / 6.0);
    return {travel_s, std::exp(-decay), period_s * period_s / mass * (0.5 - decay / 6.0),
            travel_s / mass};
  }
  const double travel_s = -std::expm1(-decay) / rate_per_s;
  return {travel_s, std::exp(-decay), (period_s - travel_s) / damping, travel_s / mass};
}

/// Matrix exponential by scaling and squaring: the series on a fraction of the period that is short
/// relative to every time constant, then repeated squaring.
HeldDevice holdWithSpring(double mass, double damping, double stiffness, double period_s) {
  const double fastest = period_s * (damping / mass + std::sqrt(stiffness / mass));
  int halvings = 0;
  while (std::ldexp(fastest, -halvings) > 0.5 && halvings < 60) ++halvings;
  const double part_s = std::ldexp(period_s, -halvings);
  Eigen::Matrix3d rate = Eigen::Matrix3d::Zero();
  rate.topRows<2>() << 0.0, part_s, 0.0,  //
      -stiffness / mass * part_s, -damping / mass * part_s, part_s / mass;
  Eigen::Matrix3d term = Eigen::Matrix3d::Identity(), sum = term;
  for (int i = 1; i < 24; ++i) {
    term = (term * rate / i).eval();
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) sum = (sum * sum).eval();
  return {sum(0, 1), sum(1, 1), sum(0, 2), sum(1, 2), 1.0 - sum(0, 0), -sum(1, 0)};
}

HeldDevice holdDevice(const AxisLoop& l) {
  const double mass = l.mass + l.person.mass;
  const double damping = l.damping + l.person.damping;
  if (l.person.stiffness == 0.0) return holdWithoutSpring(mass, damping, l.period_s);
  return holdWithSpring(mass, damping, l.person.stiffness, l.period_s);
}

Eigen::VectorXd stepLoop(const AxisLoop& loop, ContactCase contact, const HeldDevice& device,
                         const Eigen::VectorXd& s) {
  const double t = loop.period_s;
  const double vf =
      (loop.filter_tau_s * s[kVf] + (s[kXm] - s[kXmPrevious])) / (loop.filter_tau_s + t);
  const double b = loop.k_ps_per_s2 > 0.0 ? loop.k_pm * loop.k_ds_per_s / loop.k_ps_per_s2 : 0.0;
  // The effort uses the avatar's state before its step, as the tick does.
  const double effort = loop.k_pm * (s[kXs] - s[kXm]) + loop.gamma * b * (s[kVs] - vf) -
                        loop.phi_k_dm * vf - loop.wall_stiffness * s[kXm] - loop.wall_damping * vf;
  Eigen::VectorXd next = s;
  double felt = effort;
  if (loop.delay_ticks > 0) {
    felt = s[kFirstEffort];
    for (int i = 1; i < loop.delay_ticks; ++i) next[kFirstEffort + i - 1] = s[kFirstEffort + i];
    next[kFirstEffort + loop.delay_ticks - 1] = effort;
  }
  next[kXm] = s[kXm] + device.travel_s * s[kVm] + device.push_x * felt - device.fall_x * s[kXm];
  next[kVm] = device.keep * s[kVm] + device.push_v * felt - device.fall_v * s[kXm];
  next[kXmPrevious] = s[kXm];
  next[kVf] = vf;
  if (contact == ContactCase::kRigid) {
    next[kXs] = next[kVs] = 0.0;
  } else {
    const double acceleration =
        loop.k_ps_per_s2 * (s[kXm] - s[kXs]) + loop.k_ds_per_s * (vf - s[kVs]);
    // The object is solved implicitly, like the contacts of an engine, and is therefore passive.
    if (contact == ContactCase::kObject) {
      const double mass = 1.0 + loop.held_mass;
      next[kVs] = (mass * s[kVs] + t * (acceleration - loop.spring_per_s2 * s[kXs])) /
                  (mass + t * t * loop.spring_per_s2);
    } else {
      next[kVs] = s[kVs] + t * acceleration;
    }
    next[kXs] = s[kXs] + t * next[kVs];
  }
  return next;
}

/// Balances the matrix by exact powers of two until rows and columns have similar norms. Otherwise
/// entries such as a stiffness of 1e3 and a period of 1e-3 would reduce the precision of the
/// eigenvalues.
Eigen::MatrixXd balanced(Eigen::MatrixXd m) {
  const Eigen::Index n = m.rows();
  for (int sweep = 0; sweep < 30; ++sweep) {
    bool changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double column = m.col(i).lpNorm<1>() - std::abs(m(i, i));
      const double row = m.row(i).lpNorm<1>() - std::abs(m(i, i));
      if (column == 0.0 || row == 0.0) continue;
      const double scale = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (scale == 1.0) continue;
      m.col(i) *= scale;
      m.row(i) /= scale;
      changed = true;
    }
    if (!changed) break;
  }
  return m;
}

}  // namespace

AxisLoop axisLoop(const DeviceModel& device, const CouplingGains& gains, int axis,
                  double period_s) {
  AxisLoop l;
  l.mass = device.axes[axis].mass;
  l.damping = device.axes[axis].damping;
  l.delay_ticks = device.output_delay_ticks;
  l.k_pm = gains.k_pm[axis];
  l.phi_k_dm = gains.k_dm[axis];
  l.gamma = gains.gamma[axis];
  l.k_ps_per_s2 = gains.k_pm[axis] / gains.inertia[axis];
  l.filter_tau_s = gains.filter_tau_s[axis];
  l.period_s = period_s;
  l.k_ds_per_s = criticalDamping(l.k_ps_per_s2, period_s);
  return l;
}

Eigen::MatrixXd closedLoopMatrix(const AxisLoop& loop, ContactCase contact) {
  const int n = kFirstEffort + loop.delay_ticks;
  const HeldDevice device = holdDevice(loop);
  Eigen::MatrixXd matrix(n, n);
  for (int j = 0; j < n; ++j) {
    matrix.col(j) = stepLoop(loop, contact, device, Eigen::VectorXd::Unit(n, j));
  }
  return matrix;
}

Eigen::VectorXcd poles(const Eigen::MatrixXd& matrix) {
  if (!matrix.allFinite()) return {};
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(balanced(matrix), false);
  if (solver.info() != Eigen::Success) return {};
  return solver.eigenvalues();
}

double spectralRadius(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXcd found = poles(matrix);
  if (found.size() == 0) return std::numeric_limits<double>::infinity();
  return found.cwiseAbs().maxCoeff();
}

Eigen::MatrixXd avatarLoopMatrix(const AxisMatrix& reduced_inertia, const AxisStiffness& k_pm,
                                 double period_s) {
  const Eigen::Index n = reduced_inertia.rows();
  const Eigen::MatrixXd m = reduced_inertia;
  const Eigen::LLT<Eigen::MatrixXd> cholesky(m);
  // The inertia is singular: this hand has no valid dynamics.
  if (cholesky.info() != Eigen::Success) {
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
  // Bisects in the worst posture only, then checks all postures again. A search over all postures
  // at once would take seconds.
  double factor = most;
  WorstPosture worst = worstPosture(inertias, times(factor), period_s);
  // Each round starts from the new worst posture.
  for (std::size_t i = 0; i < inertias.size() && factor > 0.0 && worst.radius >= 1.0; ++i) {
    factor = roundedDown(largestAllowed(factor, [&](double f) {
      return spectralRadius(avatarLoopMatrix(inertias[worst.posture], times(f), period_s)) < 1.0;
    }));
    worst = worstPosture(inertias, times(factor), period_s);
  }
  return worst.radius < 1.0 ? factor : 0.0;
}

double largestAllowed(double start, const std::function<bool(double)>& passes) {
  if (!(start > 0.0) || !std::isfinite(start)) return 0.0;
  // 0.9^110 is below 1e-5. The steps are counted because denormal numbers do not shrink by a tenth.
  constexpr int kSteps = 110;
  double high = start;
  double low = 0.9 * start;
  for (int i = 0; !passes(low); ++i) {
    if (i == kSteps) return 0.0;
    high = low;
    low *= 0.9;
  }
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (passes(middle) ? low : high) = middle;
  }
  return low;
}

double roundedDown(double value) {
  if (!(value >= 1e-300)) return 0.0;  // smaller numbers do not have three exact digits
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return std::floor(value / unit) * unit;
}

}  // namespace wholehand
