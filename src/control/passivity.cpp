#include "control/passivity.hpp"

#include <algorithm>
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
  return -felt.real() + realPlusModulus(round_trip) / (2.0 * avatar);
}

/// The limit φ → 0, where the sweep would lose precision.
double requiredAtRest(const AxisLoop& l) {
  const double t = l.period_s, drive = l.k_ds_per_s - 0.5 * l.k_ps_per_s2 * t;
  if (!(drive > 0.0)) return std::numeric_limits<double>::infinity();
  const double reciprocal = l.gamma * l.k_pm * l.k_ds_per_s / l.k_ps_per_s2;
  const double lag = (1.0 + l.gamma) * l.k_ds_per_s - (1.0 + l.delay_ticks) * l.k_ps_per_s2 * t;
  const double passive = (l.k_pm + l.wall_stiffness) * t * (0.5 + l.delay_ticks) - reciprocal -
                         l.phi_k_dm - l.wall_damping;
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

}  // namespace wholehand
