#include "control/divided_passivity.hpp"

#include "control/coupling_gains.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Complex = std::complex<double>;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kGolden = 0.6180339887498949;

/// One axis at one image.
struct Port {
  Complex felt;              ///< Q_m
  Complex driven;            ///< Q_s
  std::vector<double> free;  ///< Re A₀ at every corner of Φ and α
  double round = 0.0;        ///< |Q_m + λ Q_sᴴ|² / 4λ, for the λ of the image
};
using Ports = std::vector<Port>;  ///< of all axes

/// The corners of Φ and of one wall's α, in which Re A₀ is affine.
std::vector<double> freeAtCorners(const AxisCase& c, double spring, double damper,
                                  double reciprocal) {
  std::vector<double> out;
  std::vector<WallCase> walls = c.walls;
  walls.push_back({});
  for (const WallCase& w : walls) {
    for (const double phi : {0.0, 1.0}) {
      out.push_back((c.gains.k_pm + w.stiffness) * spring +
                    (reciprocal + phi * c.gains.k_dm + w.damping) * damper);
    }
  }
  return out;
}

Ports portsAt(const CoupledCase& c, const AxisDamping& damping, double angle_rad,
              double step_angle_rad) {
  const double t = c.period_s, step_s = c.physics_divisor * t;
  const Complex z = std::polar(1.0, angle_rad), late = std::polar(1.0, -c.delay_ticks * angle_rad);
  const Complex held = t / (z - 1.0);
  const Complex held_slope = (1.0 - std::polar(1.0, -step_angle_rad)) / step_s;
  Ports out;
  for (std::size_t i = 0; i < c.axes.size(); ++i) {
    const AxisCase& axis = c.axes[i];
    const double tau_s = 1.0 / (2.0 * std::numbers::pi * axis.gains.velocity_filter_hz);
    const double d = damping[static_cast<int>(i)], reciprocal = axis.gains.gamma * d;
    const Complex derivative = (z - 1.0) / ((tau_s + t) * z - tau_s);
    Port port;
    port.felt = late * held * (axis.gains.k_pm + reciprocal * held_slope);
    port.driven = held * (axis.gains.k_pm + d * derivative);
    port.free =
        freeAtCorners(axis, (held * late).real(), (held * late * derivative).real(), reciprocal);
    out.push_back(port);
  }
  return out;
}

double roundOf(const Port& p, double lambda) {
  return std::norm(p.felt + lambda * std::conj(p.driven)) / (4.0 * lambda);
}

void setRound(Ports& ports, double lambda) {
  for (Port& p : ports) p.round = roundOf(p, lambda);
}

/// Logarithms of the axes' own best λ at an image: the least and the largest.
std::pair<double, double> ownLambdas(const Ports& ports) {
  double low = kInfinite, high = -kInfinite;
  for (const Port& p : ports) {
    const double own = std::log(std::abs(p.felt) / std::abs(p.driven));
    low = std::min(low, own);
    high = std::max(high, own);
  }
  return {low, high};
}

/// Seeks the λ of an image by golden section on its logarithm.
void balance(const CoupledCase& c, const Eigen::MatrixXd& inverse, Ports& ports) {
  auto [low, high] = ownLambdas(ports);
  const auto need = [&](double logarithm) {
    double most = 0.0;
    for (std::size_t i = 0; i < ports.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      most = std::max(
          most, roundOf(ports[i], std::exp(logarithm)) * inverse(k, k) / c.axes[i].axis.damping);
    }
    return most;
  };
  for (int i = 0; i < 24 && high > low; ++i) {
    const double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
    const bool lower = need(left) < need(right);
    (lower ? high : low) = lower ? right : left;
  }
  setRound(ports, std::exp(0.5 * (low + high)));
}

/// Σ round / (share b + free) of an axis at its worst corner; infinite where a term is not damped.
double demand(const CoupledCase& c, const std::vector<Ports>& images, std::size_t axis,
              double share) {
  double most = 0.0;
  for (std::size_t corner = 0; corner < images[0][axis].free.size(); ++corner) {
    double sum = 0.0;
    for (const Ports& ports : images) {
      const double damped = share * c.axes[axis].axis.damping + ports[axis].free[corner];
      if (!(damped > 0.0)) return kInfinite;
      sum += ports[axis].round / damped;
    }
    most = std::max(most, sum);
  }
  return most;
}

bool suffices(const CoupledCase& c, const std::vector<Ports>& images, Eigen::MatrixXd real,
              double share) {
  for (std::size_t i = 0; i < c.axes.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    real(k, k) -= demand(c, images, i, share);
    if (!std::isfinite(real(k, k))) return false;
  }
  return Eigen::LLT<Eigen::MatrixXd>(real).info() == Eigen::Success;
}

}  // namespace

double dividedShare(const CoupledCase& c, const AxisMatrix& inertia, double angle_rad,
                    double enough) {
  const int d = c.physics_divisor;
  const double step_s = d * c.period_s, step_angle_rad = d * angle_rad;
  AxisStiffness k_pm(static_cast<int>(c.axes.size()));
  for (int i = 0; i < k_pm.size(); ++i) k_pm[i] = c.axes[i].gains.k_pm;
  const AxisDamping damping = avatarDamping(inertia, k_pm, step_s);
  Eigen::MatrixXd real = inertia * ((1.0 - std::cos(step_angle_rad)) / step_s);
  for (int i = 0; i < k_pm.size(); ++i) {
    real(i, i) += damping[i] * std::cos(step_angle_rad) - 0.5 * step_s * k_pm[i];
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(real);
  if (cholesky.info() != Eigen::Success) return kInfinite;
  std::vector<Ports> images;
  for (int k = 0; k < d; ++k) {
    images.push_back(
        portsAt(c, damping, angle_rad + 2.0 * std::numbers::pi * k / d, step_angle_rad));
    const auto [least, most] = ownLambdas(images.back());
    setRound(images.back(), std::exp(0.5 * (least + most)));
  }
  double low = std::max(enough, 0.0), high = std::max(2.0 * low, 1.0);
  if (suffices(c, images, real, low)) return low;
  const Eigen::MatrixXd inverse =
      cholesky.solve(Eigen::MatrixXd::Identity(real.rows(), real.cols()));
  for (Ports& ports : images) balance(c, inverse, ports);
  if (suffices(c, images, real, low)) return low;
  while (!suffices(c, images, real, high)) {
    low = high;
    high *= 4.0;
    if (high > 1e12) return kInfinite;
  }
  for (int i = 0; i < 60 && high - low > 1e-10 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (suffices(c, images, real, middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace wholehand
