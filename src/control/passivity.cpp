#include "control/passivity.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace wholehand {

namespace {

using Complex = std::complex<double>;

/// Of a logarithmic sweep: the worst frequency lies near zero or near Nyquist, rarely between.
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
  return -felt.real() + realPlusModulus(round_trip) / (2.0 * avatar);
}

}  // namespace

double requiredDamping(const AxisLoop& loop, int frequencies) {
  double worst = -std::numeric_limits<double>::infinity();
  for (int i = 0; i <= frequencies; ++i) {
    const double share = static_cast<double>(i) / frequencies;
    worst = std::max(
        worst, requiredAt(loop, kLowest_rad * std::pow(std::numbers::pi / kLowest_rad, share)));
  }
  return worst;
}

}  // namespace wholehand
