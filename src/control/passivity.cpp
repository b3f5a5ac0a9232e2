#include "control/passivity.hpp"

#include "model/rendering_config.hpp"

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

/// One of the frequencies that a divided avatar does not distinguish.
struct Image {
  double free = 0.0;   ///< Re A₀
  double round = 0.0;  ///< (Re q + |q|) / 2
};
using Images = std::array<Image, kMostPhysicsDivisor>;

/// Least b with Σ round / (b + free) <= avatar. Newton's method on a function that falls and is
/// convex, from below: it never passes the solution.
double leastDamping(const Images& images, int count, double avatar) {
  double b = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < count; ++k) b = std::max(b, images[k].round / avatar - images[k].free);
  for (int i = 0; i < 60; ++i) {
    double excess = -avatar, slope = 0.0;
    for (int k = 0; k < count; ++k) {
      if (images[k].round == 0.0) continue;
      const double damped = b + images[k].free;
      excess += images[k].round / damped;
      slope += images[k].round / (damped * damped);
    }
    if (!(excess > 1e-13 * avatar)) break;
    b += excess / slope;
  }
  return b;
}

Image imageAt(const AxisLoop& l, double angle_rad, double step_angle_rad) {
  const double t = l.period_s;
  const Complex z = std::polar(1.0, angle_rad);
  const Complex travel = t / (z - 1.0), hold = travel * std::polar(1.0, -l.delay_ticks * angle_rad);
  const Complex derivative = (z - 1.0) / ((l.filter_tau_s + t) * z - l.filter_tau_s);
  const double reciprocal = l.gamma * l.k_pm * l.k_ds_per_s / l.k_ps_per_s2;
  const Complex held_slope = (1.0 - std::polar(1.0, -step_angle_rad)) / l.stepPeriod();
  const Complex felt =
      hold * (l.k_pm + l.wall_stiffness + (reciprocal + l.phi_k_dm + l.wall_damping) * derivative);
  const Complex round_trip = hold * (l.k_pm + reciprocal * held_slope) * travel *
                             (l.k_ps_per_s2 + l.k_ds_per_s * derivative);
  return {felt.real(), 0.5 * realPlusModulus(round_trip)};
}

double divided(const AxisLoop& l, double angle_rad) {
  const int d = l.physics_divisor;
  const double t = l.stepPeriod(), step_angle_rad = d * angle_rad;
  const double avatar = (1.0 - std::cos(step_angle_rad)) / t - 0.5 * t * l.k_ps_per_s2 +
                        l.k_ds_per_s * std::cos(step_angle_rad);
  if (!(avatar > 0.0)) return std::numeric_limits<double>::infinity();
  Images images;
  for (int k = 0; k < d; ++k) {
    images[k] = imageAt(l, angle_rad + 2.0 * std::numbers::pi * k / d, step_angle_rad);
  }
  return leastDamping(images, d, avatar);
}

double requiredAt(const AxisLoop& l, double angle_rad) {
  if (l.physics_divisor > 1) return divided(l, angle_rad);
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
  const double t = l.period_s, drive = l.k_ds_per_s - 0.5 * l.k_ps_per_s2 * l.stepPeriod();
  if (!(drive > 0.0)) return std::numeric_limits<double>::infinity();
  const double reciprocal = l.gamma * l.k_pm * l.k_ds_per_s / l.k_ps_per_s2;
  const double lag = (1.0 + l.gamma) * l.k_ds_per_s - (1.0 + l.delay_ticks) * l.k_ps_per_s2 * t;
  const double passive = (l.k_pm + l.wall_stiffness) * t * (0.5 + l.delay_ticks) - reciprocal -
                         l.phi_k_dm - l.wall_damping;
  if (l.physics_divisor == 1) {
    return passive + l.k_pm * lag * lag / (4.0 * l.k_ps_per_s2 * drive);
  }
  Images images;
  images[0] = {-passive, l.k_pm * lag * lag / (4.0 * l.k_ps_per_s2)};
  for (int k = 1; k < l.physics_divisor; ++k) {
    images[k] = imageAt(l, 2.0 * std::numbers::pi * k / l.physics_divisor, 0.0);
  }
  return leastDamping(images, l.physics_divisor, drive);
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
  const auto angle = [&loop, frequencies](int i) {
    const double share = static_cast<double>(std::clamp(i, 0, frequencies)) / frequencies;
    const double highest_rad = std::numbers::pi / loop.physics_divisor;
    return kLowest_rad * std::pow(highest_rad / kLowest_rad, share);
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
