#pragma once

#include "worst_termination.hpp"

#include <utility>

/// The passive person and object that need the most damping where physics runs at a divisor. The
/// avatar does not distinguish the images φ + 2πk/d of a frequency, each of which the person
/// answers with a reactance of its own.
namespace wholehand::test {

/// As TwoPort; the first two at every image.
struct DividedPort {
  std::vector<Complex> felt, round_trip;
  Complex avatar;
};

/// The avatar's state is held for d ticks: (1/d) Σ zⁱ, summed one by one.
inline DividedPort dividedPort(const AxisLoop& l, double angle_rad) {
  const int d = l.physics_divisor;
  const double t = l.period_s, step_s = l.stepPeriod();
  const Complex zeta = std::polar(1.0, d * angle_rad);
  const double b = l.gamma * l.k_pm * l.k_ds_per_s / l.k_ps_per_s2;
  DividedPort out;
  for (int k = 0; k < d; ++k) {
    const Complex z = std::polar(1.0, angle_rad + 2.0 * std::numbers::pi * k / d);
    Complex held = 0.0;
    for (int i = 0; i < d; ++i) held += std::pow(z, i) / static_cast<double>(d);
    const Complex late = std::pow(z, -l.delay_ticks), integral = t / (z - 1.0);
    const Complex slope = (z - 1.0) / ((l.filter_tau_s + t) * z - l.filter_tau_s);
    out.felt.push_back(late * integral *
                       (l.k_pm + l.wall_stiffness + (b + l.phi_k_dm + l.wall_damping) * slope));
    out.round_trip.push_back(late * held * (l.k_pm * step_s / (zeta - 1.0) + b / zeta) * integral *
                             (l.k_ps_per_s2 + l.k_ds_per_s * slope));
  }
  out.avatar =
      (1.0 - 1.0 / zeta) / step_s + l.k_ps_per_s2 * step_s / (zeta - 1.0) + l.k_ds_per_s / zeta;
  return out;
}

/// What an image takes of the avatar's Re R.
inline double imageShare(const DividedPort& p, std::size_t k, double damping) {
  const double damped = damping + p.felt[k].real();
  if (!(damped > 0.0)) return std::numeric_limits<double>::infinity();
  return (std::abs(p.round_trip[k]) + p.round_trip[k].real()) / (2.0 * damped * p.avatar.real());
}

/// Least damping with which no lossless reactances of person and object let it swing, by bisection.
inline double dividedNeed(const DividedPort& p) {
  const auto enough = [&p](double damping) {
    double sum = 0.0;
    for (std::size_t k = 0; k < p.felt.size(); ++k) sum += imageShare(p, k, damping);
    return sum <= 1.0;
  };
  double low = -1e6, high = 1e6;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (enough(middle) ? high : low) = middle;
  }
  return high;
}

/// The reactance at every image of the swing. Device and person go by the trapezoidal rule, which
/// has no images about the tick rate (required_damping_figures_test.cpp has those): s = 2/T
/// tan(φ/2). Not built, and not passive, where two images are so close, to each other or to
/// Nyquist, that their person answers too steeply to swing in a time one can wait for.
inline void buildDividedPerson(Termination& t, const AxisLoop& l,
                               const std::vector<double>& reactances) {
  constexpr double kClose_rad = 0.04;
  std::vector<std::pair<double, double>> all;
  for (std::size_t k = 0; k < reactances.size(); ++k) {
    const double angle_rad =
        t.angle_rad + 2.0 * std::numbers::pi * static_cast<double>(k) / l.physics_divisor;
    const double sign = angle_rad < std::numbers::pi ? 1.0 : -1.0;  // the mirror image
    if (std::isnan(reactances[k])) continue;                        // takes almost nothing
    all.emplace_back(sign > 0.0 ? angle_rad : 2.0 * std::numbers::pi - angle_rad,
                     sign * reactances[k]);
  }
  std::sort(all.begin(), all.end());
  std::vector<double> at, wanted;
  double before_rad = -1.0;
  for (const auto& [angle_rad, reactance] : all) {
    if (angle_rad - before_rad < kClose_rad || std::numbers::pi - angle_rad < kClose_rad) return;
    before_rad = angle_rad;
    at.push_back(2.0 / l.period_s * std::tan(0.5 * angle_rad));
    wanted.push_back(reactance);
  }
  t.trapezoidal = true;
  for (double closer = 1.0; closer > 1e-3; closer *= 0.5) {
    buildPerson(t, l.mass, at, wanted, closer);
    if (isPassive(t)) return;
  }
}

/// @param highest of the angles searched, of π/d: beyond it two images are too close to build
inline Termination worstDivided(const AxisLoop& l, double highest = 0.9) {
  constexpr int kAngles = 1501;
  constexpr double kSlowest_rad = 2e-5, kSlow_rad = 0.05;
  const double top_rad = highest * std::numbers::pi / l.physics_divisor;
  const auto angle = [top_rad](int i) {
    return kSlowest_rad * std::pow(top_rad / kSlowest_rad, static_cast<double>(i) / kAngles);
  };
  std::vector<double> needed;
  for (int i = 0; i <= kAngles; ++i) needed.push_back(dividedNeed(dividedPort(l, angle(i))));
  auto at = static_cast<int>(std::max_element(needed.begin(), needed.end()) - needed.begin());
  Termination t;
  t.most = needed[at];
  while (at < kAngles && angle(at) < kSlow_rad && needed[at + 1] > (1.0 - kWaiting) * t.most) ++at;
  t.angle_rad = angle(at);
  const DividedPort p = dividedPort(l, t.angle_rad);
  t.needed = needed[at];
  // On the edge of the disc of q / (b + A₀ + jX), where its real part is largest.
  std::vector<double> reactances;
  Complex around = 0.0;
  for (std::size_t k = 0; k < p.felt.size(); ++k) {
    const double damped = t.needed + p.felt[k].real();
    if (imageShare(p, k, t.needed) < 1e-3) {
      reactances.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const double slope = std::tan(0.5 * std::arg(p.round_trip[k]));
    reactances.push_back(damped * slope - p.felt[k].imag());
    around += p.round_trip[k] / (damped * Complex(1.0, slope));
  }
  const double object = (around - p.avatar).imag();
  const double half = std::tan(0.5 * l.physics_divisor * t.angle_rad);
  if (object > 0.0) {
    t.held_mass = 0.5 * l.stepPeriod() * object / half;
  } else {
    t.spring_per_s2 = -2.0 / l.stepPeriod() * object * half;
  }
  buildDividedPerson(t, l, reactances);
  return t;
}

}  // namespace wholehand::test
