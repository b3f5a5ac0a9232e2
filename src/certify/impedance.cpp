#include "certify/impedance.hpp"

#include <Eigen/LU>

#include <cmath>
#include <numbers>

namespace wholehand {

namespace {

using Complex = std::complex<double>;
using ComplexMatrix = Eigen::MatrixXcd;
using ComplexVector = Eigen::VectorXcd;

/// φ_k(x) = Σ xⁱ / (i + k)!, the integrals of the exponential for an effort that is constant (k =
/// 1), linear (k = 2) and so on over a period.
double phiFunction(int k, double x) {
  double factorial = 1.0;
  for (int i = 2; i <= k; ++i) factorial *= i;
  if (std::abs(x) < 1.0) {
    double sum = 0.0, term = 1.0 / factorial;
    for (int i = 1; i <= 20; ++i) {
      sum += term;
      term *= x / (i + k);
    }
    return sum;
  }
  if (k == 0) return std::exp(x);
  return (phiFunction(k - 1, x) - k / factorial) / x;  // φ_{k−1} − 1/(k−1)!
}

/// Transfer function at z from effort to position of m ẍ + b ẋ = f, for a held effort and for an
/// effort that is linear between samples.
struct SampledDevice {
  Complex held, joined;
};

SampledDevice sampledDevice(const AxisLoop& l, Complex z) {
  const double t = l.period_s, decay = -l.damping * t / l.mass;
  const double p1 = phiFunction(1, decay), p2 = phiFunction(2, decay), p3 = phiFunction(3, decay);
  const Complex step = z - 1.0;
  const auto position = [&](Complex pushed_x, Complex pushed_v) {
    const Complex velocity = t / l.mass * pushed_v / (z - std::exp(decay));
    return (t * p1 * velocity + t * t / l.mass * pushed_x) / step;
  };
  return {position(p2, p1), position(p2 + p3 * step, p1 + p2 * step)};
}

Complex continuousDevice(const AxisLoop& l, double omega_rad_s) {
  return {l.damping, omega_rad_s * l.mass};
}

/// Response of the avatar on the axis to a unit motion of the device.
struct Follower {
  Complex position = 0.0, velocity = 0.0;
};

/// Solves M (z − 1) v = T (K (x − q) + D (d x − v) − contact), q (z − 1) = T z v, with d the
/// filtered derivative.
Follower follow(const FeltLoop& felt, ContactCase contact, Complex z, Complex derivative) {
  if (contact == ContactCase::kRigid) return {};
  const double t = felt.loop.period_s;
  const Eigen::Index n = felt.inertia.rows(), a = felt.axis;
  const Complex sum = t * z / (z - 1.0);  // from velocity to position
  ComplexMatrix system = (z - 1.0) * felt.inertia.cast<Complex>();
  for (Eigen::Index i = 0; i < n; ++i) {
    const int axis = static_cast<int>(i);
    system(i, i) += t * (felt.k_pm[axis] * sum + felt.avatar_damping[axis]);
  }
  const double own = felt.inertia(a, a);
  if (contact == ContactCase::kObject) {
    const double stiffness = felt.loop.spring_per_s2 * own;
    system(a, a) += (z - 1.0) * (felt.loop.held_mass * own + t * t * stiffness) +
                    t * stiffness * (sum + t);  // the spring force after the step (implicit)
  }
  ComplexVector drive = ComplexVector::Zero(n);
  drive[a] = t * (felt.k_pm[felt.axis] + felt.avatar_damping[felt.axis] * derivative);
  const ComplexVector velocity = system.partialPivLu().solve(drive);
  return {sum * velocity[a], velocity[a]};
}

/// R(z): effort of Eq. (3) per device position.
Complex effort(const FeltLoop& felt, ContactCase contact, Complex z) {
  const AxisLoop& l = felt.loop;
  const Complex derivative = (z - 1.0) / ((l.filter_tau_s + l.period_s) * z - l.filter_tau_s);
  const Follower avatar = follow(felt, contact, z, derivative);
  // D of the axis in rendered units. The loop of a single axis has unit inertia.
  const double b = l.k_pm * felt.avatar_damping[felt.axis] / felt.k_pm[felt.axis];
  return l.k_pm * (avatar.position - 1.0) + l.gamma * b * (avatar.velocity - derivative) -
         (l.phi_k_dm + l.wall_damping) * derivative - l.wall_stiffness;
}

}  // namespace

FeltLoop feltUncoupled(const AxisLoop& loop) {
  FeltLoop felt;
  felt.loop = loop;
  felt.inertia = AxisMatrix::Identity(1, 1);
  felt.k_pm = AxisStiffness(1, loop.k_ps_per_s2);
  felt.avatar_damping = AxisDamping(1, loop.k_ds_per_s);
  return felt;
}

FeltImpedance feltImpedance(const FeltLoop& felt, ContactCase contact, double frequency_hz) {
  const AxisLoop& l = felt.loop;
  const double omega_rad_s = 2.0 * std::numbers::pi * frequency_hz;
  const Complex z = std::polar(1.0, omega_rad_s * l.period_s);
  const Complex late = std::polar(1.0, -omega_rad_s * l.period_s * l.delay_ticks);
  const Complex device = continuousDevice(l, omega_rad_s);
  const Complex rendered = -device * sampledDevice(l, z).held * late * effort(felt, contact, z);
  return {device + rendered, rendered};
}

Complex linearHoldGain(const AxisLoop& loop, double frequency_hz) {
  const double omega_rad_s = 2.0 * std::numbers::pi * frequency_hz;
  const Complex z = std::polar(1.0, omega_rad_s * loop.period_s);
  return sampledDevice(loop, z).joined * Complex(0.0, omega_rad_s) *
         continuousDevice(loop, omega_rad_s);
}

}  // namespace wholehand
