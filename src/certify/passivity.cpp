#include "certify/passivity.hpp"

#include "loop/control/bilateral_coupling.hpp"
#include "loop/control/viscoelastic.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace wholehand {
namespace {

using Complex = std::complex<double>;

/// Lower end of the logarithmic sweep. The worst frequency lies near zero or near Nyquist, rarely
/// between.
constexpr double kLowest_rad = 2e-5;

/// Re q + |q| without cancellation where Re q < 0.
double realPlusModulus(const Complex& q) {
  if (q.real() >= 0.0) return q.real() + std::abs(q);
  return q.imag() * q.imag() / (std::abs(q) - q.real());
}

double requiredAt(const AxisLoop& l, double angle_rad) {
  const double t = l.period_s;
  const double avatar = (1.0 - std::cos(angle_rad)) / t - 0.5 * t * l.k_ps_per_s2 +
                        l.k_ds_per_s * std::cos(angle_rad);
  if (!(avatar > 0.0)) return std::numeric_limits<double>::infinity();
  const Complex z = std::polar(1.0, angle_rad);
  const Complex hold = t / (z - 1.0) * std::polar(1.0, -l.delay_ticks * angle_rad);
  const Complex derivative = (z - 1.0) / ((l.filter_tau_s + t) * z - l.filter_tau_s);
  const double reciprocal = l.gamma * l.k_pm * l.k_ds_per_s / l.k_ps_per_s2;
  const Complex felt =
      hold * (l.k_pm + l.wall_stiffness + (reciprocal + l.phi_k_dm + l.wall_damping) * derivative);
  const Complex round_trip = hold * (l.k_pm * t / (z - 1.0) + reciprocal / z) *
                             (l.k_ps_per_s2 + l.k_ds_per_s * derivative);
  return l.wall_late - felt.real() + realPlusModulus(round_trip) / (2.0 * avatar);
}

/// Required damping in the limit φ → 0, where the sweep would lose precision.
double requiredAtRest(const AxisLoop& l) {
  const double t = l.period_s, drive = l.k_ds_per_s - 0.5 * l.k_ps_per_s2 * t;
  if (!(drive > 0.0)) return std::numeric_limits<double>::infinity();
  const double reciprocal = l.gamma * l.k_pm * l.k_ds_per_s / l.k_ps_per_s2;
  const double lag = (1.0 + l.gamma) * l.k_ds_per_s - (1.0 + l.delay_ticks) * l.k_ps_per_s2 * t;
  const double passive = (l.k_pm + l.wall_stiffness) * t * (0.5 + l.delay_ticks) - reciprocal -
                         l.phi_k_dm - l.wall_damping + l.wall_late;
  return passive + l.k_pm * lag * lag / (4.0 * l.k_ps_per_s2 * drive);
}

/// Maximum between two angles that enclose one peak, by ternary search.
double largestBetween(const AxisLoop& l, double low_rad, double high_rad) {
  for (int i = 0; i < 40; ++i) {
    const double third = (high_rad - low_rad) / 3.0;
    if (requiredAt(l, low_rad + third) < requiredAt(l, high_rad - third)) {
      low_rad += third;
    } else {
      high_rad -= third;
    }
  }
  return requiredAt(l, 0.5 * (low_rad + high_rad));
}

using ComplexMatrix = Eigen::MatrixXcd;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kLowestCoupled_rad = 2e-5;
constexpr double kEven_rad = 0.06;  // angles are spaced logarithmically below, evenly above
/// Number of frequencies of the coarse sweep in every posture and of the fine sweep in the worst
/// one.
constexpr int kCoarse = 32, kFine = 400;
constexpr int kPeakSteps = 20;  // steps that narrow the interval to 3e-4 of two spacings
/// Values of p (see the header) tried for Persons::kAny; the value that requires the least damping
/// at the reference is used. A weight of 0 selects kLinear.
constexpr std::array<double, 6> kWeights = {1.0, 1.2, 1.4, 1.6, 1.8, 2.0};
constexpr double kGolden = 0.6180339887498949;

/// Quantities of one axis at one frequency.
struct Port {
  Complex felt;       ///< Q_m
  Complex driven;     ///< Q_s
  double free = 0.0;  ///< least Re A₀ over every Φ and α; for kAny with the term of a changing Φ
  double b = 0.0;     ///< device damping
};

/// Quantities of one posture at one frequency.
struct Point {
  std::vector<Port> ports;
  Eigen::MatrixXd inverse;  ///< (Re R)⁻¹
  bool drives = false;      ///< Re R is positive definite
};

/// Least Re A₀ over Φ and α. Re A₀ is affine in Φ and in the α of each wall, so the minimum lies at
/// a corner.
/// @param held T/(z − 1) @param late z⁻ⁿ
double leastFree(const AxisCase& c, double weight, Complex held, Complex late, Complex derivative,
                 double felt_damping) {
  const double spring = (held * late).real(), damper = (held * late * derivative).real();
  const double adaptive =
      weight == 0.0 ? std::min(0.0, damper)
                    : -std::norm(std::conj(late) - weight * held * derivative) / (4.0 * weight);
  double least = c.gains.k_pm * spring + felt_damping * damper + c.gains.k_dm * adaptive;
  double wall = 0.0;
  for (const WallCase& w : c.walls) {
    wall = std::min(wall, w.stiffness * spring + w.damping * damper -
                              lateDamping(w.stiffness, w.resistance, c.delay_ticks, c.period_s));
  }
  return least + wall;
}

Point look(const CoupledCase& c, double weight, const AxisMatrix& inertia, double angle_rad) {
  const double t = c.period_s;
  const auto n = static_cast<Eigen::Index>(c.axes.size());
  const Complex z = std::polar(1.0, angle_rad), late = std::polar(1.0, -c.delay_ticks * angle_rad);
  const Complex held = t / (z - 1.0);
  AxisStiffness k_pm(static_cast<int>(n));
  for (int i = 0; i < k_pm.size(); ++i) k_pm[i] = c.axes[i].gains.k_pm;
  const AxisDamping damping = avatarDamping(inertia, k_pm, t);
  Point out;
  Eigen::MatrixXd real = inertia * ((1.0 - std::cos(angle_rad)) / t);
  for (Eigen::Index i = 0; i < n; ++i) {
    const AxisCase& axis = c.axes[i];
    const int a = static_cast<int>(i);
    const double tau_s = 1.0 / (2.0 * std::numbers::pi * axis.gains.velocity_filter_hz);
    const Complex derivative = (z - 1.0) / ((tau_s + t) * z - tau_s);
    const double felt_damping = axis.gains.gamma * damping[a];
    Port port;
    port.felt = late * (k_pm[a] * held + felt_damping / z);
    port.driven = held * (k_pm[a] + damping[a] * derivative);
    port.free = leastFree(axis, weight, held, late, derivative, felt_damping);
    port.b = axis.axis.damping;
    out.ports.push_back(port);
    real(i, i) += damping[a] * std::cos(angle_rad) - 0.5 * t * k_pm[a];
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(real);
  out.drives = cholesky.info() == Eigen::Success;
  if (out.drives) out.inverse = cholesky.solve(Eigen::MatrixXd::Identity(n, n));
  return out;
}

/// b^-½ (E (4 λ Re R)⁻¹ Eᴴ − Re A₀) b^-½. Its largest eigenvalue is the required share of b.
ComplexMatrix needed(const Point& at, double lambda) {
  const auto n = static_cast<Eigen::Index>(at.ports.size());
  ComplexMatrix out(n, n);
  std::vector<Complex> e;
  for (const Port& p : at.ports) {
    e.push_back((p.felt + lambda * std::conj(p.driven)) / std::sqrt(p.b));
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < n; ++k) {
      out(i, k) = e[i] * at.inverse(i, k) * std::conj(e[k]) / (4.0 * lambda);
    }
    const Port& p = at.ports[i];
    out(i, i) -= p.free / p.b;
  }
  return out;
}

double shareAt(const Point& at, double lambda) {
  const Eigen::SelfAdjointEigenSolver<ComplexMatrix> solver(needed(at, lambda),
                                                            Eigen::EigenvaluesOnly);
  return solver.info() == Eigen::Success ? solver.eigenvalues().maxCoeff() : kInfinite;
}

/// Required share of b if the inertia coupled no axes.
double shareOfAxes(const Point& at, double lambda) {
  double most = -kInfinite;
  for (std::size_t i = 0; i < at.ports.size(); ++i) {
    const Port& p = at.ports[i];
    const auto k = static_cast<Eigen::Index>(i);
    const double need =
        std::norm(p.felt + lambda * std::conj(p.driven)) * at.inverse(k, k) / (4.0 * lambda);
    most = std::max(most, (need - p.free) / p.b);
  }
  return most;
}

/// The best λ, by golden section on its logarithm. The condition is affine in λ and in a matrix, so
/// the passing values form an interval and the minimum is unique. It lies between the smallest and
/// largest of the axes' own best values |Q_m|/|Q_s|.
template <class Share>
double bestLambda(const Point& at, Share share, int steps) {
  double low = kInfinite, high = -kInfinite;
  for (const Port& p : at.ports) {
    const double own = std::log(std::abs(p.felt) / std::abs(p.driven));
    low = std::min(low, own);
    high = std::max(high, own);
  }
  const double spread = high - low;
  low -= 0.5 * spread;
  high += 0.5 * spread;
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = share(at, std::exp(left)), at_right = share(at, std::exp(right));
  for (int i = 0; i < steps; ++i) {
    if (at_left < at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = share(at, std::exp(left));
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = share(at, std::exp(right));
    }
  }
  return std::exp(0.5 * (low + high));
}

/// Angle `i` of the sweep. A quarter of the angles is spaced logarithmically towards zero, the
/// others evenly up to Nyquist.
double angleAt(int i, int count) {
  const int slow = count / 4;
  if (i <= slow) {
    return kLowestCoupled_rad *
           std::pow(kEven_rad / kLowestCoupled_rad, static_cast<double>(i) / slow);
  }
  return kEven_rad + (std::numbers::pi - kEven_rad) * (i - slow) / (count - slow);
}

/// Required share at one angle. @param worst largest share so far; points that require less are not
/// refined
RequiredShare needAt(const CoupledCase& c, double weight, std::size_t posture, double angle_rad,
                     double worst) {
  const double frequency_hz = angle_rad / (2.0 * std::numbers::pi * c.period_s);
  const Point at = look(c, weight, c.inertias[posture], angle_rad);
  if (!at.drives) return {kInfinite, frequency_hz, 1.0, posture};
  if (weight > 0.0) return {shareAt(at, 1.0), frequency_hz, 1.0, posture};
  double lambda = bestLambda(at, shareOfAxes, 20);
  double share = shareAt(at, lambda);
  if (share > worst) {
    lambda = bestLambda(at, shareAt, 24);
    share = shareAt(at, lambda);
  }
  return {share, frequency_hz, lambda, posture};
}

RequiredShare largestNeed(const CoupledCase& c, double weight) {
  RequiredShare worst{-kInfinite, 0.0, 1.0, 0};
  double low_rad = 0.0, high_rad = 0.0;  // angles on both sides of the worst point
  const auto look_at = [&](std::size_t posture, double angle_rad) {
    const RequiredShare found = needAt(c, weight, posture, angle_rad, worst.share);
    const bool worse = found.share > worst.share;
    if (worse) worst = found;
    return worse;
  };
  const auto sweep = [&](std::size_t posture, int count) {
    const auto angle = [count](int i) { return angleAt(std::clamp(i, 0, count), count); };
    for (int i = 0; i <= count && worst.share < kInfinite; ++i) {
      if (!look_at(posture, angle(i))) continue;
      low_rad = angle(i - 1);
      high_rad = angle(i + 1);
    }
  };
  for (std::size_t p = 0; p < c.inertias.size(); ++p) sweep(p, kCoarse);
  sweep(worst.posture, kFine);
  if (!(worst.share < kInfinite)) return worst;
  // The maximum may lie between the sweep points.
  const std::size_t posture = worst.posture;
  const auto share = [&](double angle_rad) {
    return needAt(c, weight, posture, angle_rad, -kInfinite).share;
  };
  for (int i = 0; i < kPeakSteps; ++i) {
    const double third_rad = (high_rad - low_rad) / 3.0;
    const bool rises = share(low_rad + third_rad) < share(high_rad - third_rad);
    (rises ? low_rad : high_rad) += rises ? third_rad : -third_rad;
  }
  look_at(posture, 0.5 * (low_rad + high_rad));
  return worst;
}

}  // namespace

double requiredDamping(const AxisLoop& loop, int frequencies) {
  const auto angle = [frequencies](int i) {
    const double share = static_cast<double>(std::clamp(i, 0, frequencies)) / frequencies;
    return kLowest_rad * std::pow(std::numbers::pi / kLowest_rad, share);
  };
  double worst = -std::numeric_limits<double>::infinity();
  int at = 0;
  for (int i = 0; i <= frequencies; ++i) {
    const double required = requiredAt(loop, angle(i));
    if (required > worst) {
      worst = required;
      at = i;
    }
  }
  // The maximum may lie between the sweep points.
  return std::max(
      {worst, largestBetween(loop, angle(at - 1), angle(at + 1)), requiredAtRest(loop)});
}

CoupledCase coupledCase(const CertificateInput& input) {
  CoupledCase c;
  c.delay_ticks = input.device.output_delay_ticks;
  c.period_s = input.period_s;
  c.persons = input.persons;
  AxisInertia armature(input.device.axisCount());
  for (int i = 0; i < input.device.axisCount(); ++i) {
    c.axes.push_back(axisCase(input, i));
    armature[i] = c.axes.back().armature();
  }
  c.inertias.push_back(withArmature(input.inertia_at_reference, armature));
  for (const AxisMatrix& m : input.inertias) c.inertias.push_back(withArmature(m, armature));
  return c;
}

RequiredShare requiredShare(const CoupledCase& c) {
  if (c.persons == Persons::kLinear) return largestNeed(c, 0.0);
  CoupledCase at_reference = c;
  at_reference.inertias = {c.inertias.front()};
  const auto needs_less = [&](double one, double other) {
    return largestNeed(at_reference, one).share < largestNeed(at_reference, other).share;
  };
  return largestNeed(c, *std::min_element(kWeights.begin(), kWeights.end(), needs_less));
}

}  // namespace wholehand
