#pragma once

#include "loop/control/axis_loop.hpp"
#include "loop/device/simulated/axis_dynamics.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

/// Builds the passive person and the passive object that need the most damping, from the two-port
/// of one axis, and simulates the axis in time with them (derivation: docs/certificate.md, Proofs).
namespace wholehand::test {

/// Integration of the object. kLossless loses no energy (trapezoidal rule); with dampers it covers
/// every linear passive object. kEngine steps as an engine solves contacts (backward Euler), which
/// damps fast oscillations.
enum class World { kLossless, kEngine };

/// Device b and person W, coupling, avatar and object Z at z = e^{jφ}. The loop oscillates undamped
/// where b + W + felt − round_trip / (avatar + Z) = 0.
struct TwoPort {
  Complex felt, round_trip, avatar;
};

inline TwoPort twoPort(const AxisLoop& l, double angle_rad) {
  const double t = l.period_s;
  const Complex z = std::polar(1.0, angle_rad);
  const Complex integral = t / (z - 1.0), held = integral * std::pow(z, -l.delay_ticks);
  const Complex slope = (z - 1.0) / ((l.filter_tau_s + t) * z - l.filter_tau_s);
  const double b = l.gamma * l.k_pm * l.k_ds_per_s / l.k_ps_per_s2;
  return {held * (l.k_pm + l.wall_stiffness + (b + l.phi_k_dm + l.wall_damping) * slope),
          held * (l.k_pm * integral + b / z) * (l.k_ps_per_s2 + l.k_ds_per_s * slope),
          (1.0 - 1.0 / z) / t + l.k_ps_per_s2 * integral + l.k_ds_per_s / z};
}

/// The object that needs the most damping at one frequency. It lies on the boundary of the passive
/// ones: a mass, a spring, none or a stop (infinite).
struct WorstObject {
  Complex impedance;
  double needed = 0.0;
};

inline WorstObject worstObject(const TwoPort& p, double angle_rad, World world) {
  const double edge_rad =
      0.5 * (world == World::kLossless ? std::numbers::pi : std::numbers::pi - angle_rad);
  WorstObject worst{std::numeric_limits<double>::infinity(), -p.felt.real()};
  const auto consider = [&](Complex impedance) {
    const double needed = -p.felt.real() + (p.round_trip / (p.avatar + impedance)).real();
    if (needed > worst.needed) worst = {impedance, needed};
  };
  consider(0.0);
  for (const double edge : {edge_rad, -edge_rad}) {
    // Along the boundary the real part is largest where its slope is zero: a quadratic equation.
    const Complex a = p.avatar * std::polar(1.0, -edge), q = p.round_trip * std::polar(1.0, -edge);
    for (const double root : {std::abs(q), -std::abs(q)}) {
      const double along = (root * std::abs(a.imag()) - q.imag() * a.imag()) / q.real() - a.real();
      if (std::isfinite(along) && along > 0.0) consider(std::polar(along, edge));
    }
  }
  return worst;
}

/// A mass attached to the handle by a spring.
struct HungMass {
  double stiffness = 0.0, rate_per_s = 0.0;
  [[nodiscard]] double mass() const { return stiffness / (rate_per_s * rate_per_s); }
};

/// A person and an object without losses; only the device's damping dissipates energy.
struct Termination {
  double angle_rad = 0.0;  ///< angle at which the oscillation begins
  double most = 0.0;       ///< damping that the worst of all passive persons and objects needs
  double needed = 0.0;  ///< damping needed at angle_rad; a fast oscillation is preferred to a slow
                        ///< one that is hardly worse
  double mass = 0.0, stiffness = 0.0;  ///< of device and person together
  std::vector<HungMass> hung;
  World world = World::kLossless;
  bool rigid = false;
  double held_mass = 0.0, spring_per_s2 = 0.0;
};

/// Largest share of the needed damping that is given up for an oscillation fast enough to simulate.
constexpr double kWaiting = 0.006;
/// Number of images of the oscillation at multiples of the tick rate that the person also responds
/// to.
constexpr int kImages = 20;

/// Finds mass, spring and attached masses that have the wanted reactances at the given rates
/// [rad/s], which are in rising order. Each reactance is one linear equation.
inline void buildPerson(Termination& t, double device_mass, const std::vector<double>& at,
                        const std::vector<double>& wanted) {
  t.hung.clear();
  t.mass = std::max(device_mass, 1.0001 * wanted[0] / at[0]);
  const auto n = static_cast<Eigen::Index>(at.size());
  Eigen::MatrixXd m(n, n);
  Eigen::VectorXd rest(n);
  for (Eigen::Index i = 1; i < n; ++i) {  // each below its image, well above the one before
    const double w = at[i];
    const double gap = w - at[i - 1];
    t.hung.push_back({0.0, w - std::min(0.03 * w, 0.3 * gap)});
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const double w = at[i];
    m(i, 0) = -1.0 / w;
    for (Eigen::Index k = 1; k < n; ++k) {
      const double own = t.hung[k - 1].rate_per_s;
      m(i, k) = w / (own * own - w * w);
    }
    rest[i] = wanted[i] - t.mass * w;
  }
  const Eigen::VectorXd solved = m.partialPivLu().solve(rest);
  t.stiffness = solved[0];
  for (Eigen::Index i = 1; i < n; ++i) {
    t.hung[i - 1].stiffness = solved[i];
  }
}

/// The same from the reactance at the oscillation's frequency and at its images, since a sampled
/// position cannot distinguish them.
inline void buildPerson(Termination& t, double device_mass, double reactance, double period_s,
                        int images) {
  const double rate = 2.0 * std::numbers::pi / period_s, first = t.angle_rad / period_s;
  const bool nyquist = t.angle_rad > std::numbers::pi - 1e-6;
  std::vector<double> at = {first}, wanted = {nyquist ? 0.0 : reactance};
  for (int i = 1; i <= images; ++i) {
    const int k = (i + 1) / 2;
    const bool mirrored = !nyquist && i % 2 == 1;
    at.push_back(nyquist ? (i + 0.5) * rate : mirrored ? k * rate - first : k * rate + first);
    wanted.push_back(nyquist ? 0.0 : mirrored ? -reactance : reactance);
  }
  buildPerson(t, device_mass, at, wanted);
}

/// True if every mass and spring has an admissible sign.
inline bool isPassive(const Termination& t) {
  return t.mass > 0.0 && t.stiffness >= 0.0 && t.held_mass >= 0.0 && t.spring_per_s2 >= 0.0 &&
         std::all_of(t.hung.begin(), t.hung.end(),
                     [](const HungMass& h) { return h.stiffness > 0.0; });
}

inline Termination worstTermination(const AxisLoop& l, World world, int images = kImages) {
  constexpr int kAngles = 3001;  // a grid other than that of requiredDamping()
  constexpr double kSlowest_rad = 2e-5, kSlow_rad = 0.05;
  const auto angle = [](int i) {
    return kSlowest_rad *
           std::pow(std::numbers::pi / kSlowest_rad, static_cast<double>(i) / kAngles);
  };
  std::vector<double> needed;
  for (int i = 0; i <= kAngles; ++i) {
    needed.push_back(worstObject(twoPort(l, angle(i)), angle(i), world).needed);
  }
  auto at = static_cast<int>(std::max_element(needed.begin(), needed.end()) - needed.begin());
  Termination t;
  t.world = world;
  t.most = needed[at];
  while (angle(at) < kSlow_rad && needed[at + 1] > (1.0 - kWaiting) * t.most) {
    ++at;
  }
  t.angle_rad = angle(at);
  const TwoPort p = twoPort(l, t.angle_rad);
  const WorstObject object = worstObject(p, t.angle_rad, world);
  t.needed = object.needed;
  t.rigid = std::isinf(object.impedance.real());
  const Complex around = t.rigid ? Complex{} : p.round_trip / (p.avatar + object.impedance);
  const double half = 0.5 * t.angle_rad;
  const double size = t.rigid ? 0.0 : std::abs(object.impedance);
  if (object.impedance.imag() > 0.0) {
    t.held_mass =
        0.5 * l.period_s * size / (world == World::kLossless ? std::tan(half) : std::sin(half));
  } else {
    t.spring_per_s2 =
        2.0 / l.period_s * size * (world == World::kLossless ? std::tan(half) : std::sin(half));
  }
  buildPerson(t, l.mass, (around - p.felt).imag(), l.period_s, t.angle_rad < 0.1 ? 0 : images);
  return t;
}

/// One axis with a termination, tick by tick, linear in its state
/// [x, v, (x, v) of every attached mass | x before, v_f, x_s, v_s, force of lossless mass,
/// efforts].
class TerminatedAxis {
 public:
  TerminatedAxis(const AxisLoop& loop, const Termination& t)
      : l_(loop), t_(t), moving_(2 + 2 * static_cast<Eigen::Index>(t.hung.size())) {
    Eigen::MatrixXd rate = Eigen::MatrixXd::Zero(moving_ + 1, moving_ + 1);
    rate(0, 1) = 1.0;
    rate(1, 0) = -t.stiffness / t.mass;
    rate(1, 1) = -loop.damping / t.mass;
    rate(1, moving_) = 1.0 / t.mass;
    for (std::size_t i = 0; i < t.hung.size(); ++i) {
      const auto at = 2 + 2 * static_cast<Eigen::Index>(i);
      const double squared = t.hung[i].rate_per_s * t.hung[i].rate_per_s;
      rate(1, 0) -= t.hung[i].stiffness / t.mass;
      rate(1, at) = t.hung[i].stiffness / t.mass;
      rate(at, at + 1) = 1.0;
      rate(at + 1, 0) = squared;
      rate(at + 1, at) = -squared;
    }
    held_ = matrixExponential(loop.period_s * rate).topRows(moving_);
  }

  [[nodiscard]] Eigen::Index size() const { return moving_ + 5 + l_.delay_ticks; }

  [[nodiscard]] Eigen::VectorXd tick(const Eigen::VectorXd& s) const {
    const double t = l_.period_s;
    const Eigen::Index tail = moving_, efforts = moving_ + 5;
    const double x = s[0], xs = s[tail + 2], vs = s[tail + 3], force = s[tail + 4];
    const double vf = (l_.filter_tau_s * s[tail + 1] + x - s[tail]) / (l_.filter_tau_s + t);
    const double b = l_.gamma * l_.k_pm * l_.k_ds_per_s / l_.k_ps_per_s2;
    const double effort = l_.k_pm * (xs - x) + b * (vs - vf) - l_.phi_k_dm * vf -
                          l_.wall_stiffness * x - l_.wall_damping * vf;
    Eigen::VectorXd next = Eigen::VectorXd::Zero(size());
    double felt = effort;
    if (l_.delay_ticks > 0) {
      felt = s[efforts];
      next.segment(efforts, l_.delay_ticks - 1) = s.segment(efforts + 1, l_.delay_ticks - 1);
      next[efforts + l_.delay_ticks - 1] = effort;
    }
    next.head(moving_) = held_.leftCols(moving_) * s.head(moving_) + held_.col(moving_) * felt;
    next[tail] = x;
    next[tail + 1] = vf;
    if (t_.rigid) return next;
    const double driven = vs + t * (l_.k_ps_per_s2 * (x - xs) + l_.k_ds_per_s * (vf - vs));
    const double spring = t * t * t_.spring_per_s2;
    double after = 0.0;
    if (t_.world == World::kEngine) {  // mass and spring use the velocity after the tick
      after =
          (driven + t_.held_mass * vs - t * t_.spring_per_s2 * xs) / (1.0 + t_.held_mass + spring);
    } else {  // the spring uses the mean position, the mass the mean force
      const double mass = 2.0 * t_.held_mass;
      after = (driven + mass * vs + t * force - t * t_.spring_per_s2 * xs) /
              (1.0 + mass + 0.5 * spring);
      if (mass > 0.0) next[tail + 4] = mass / t * (after - vs) - force;
    }
    next[tail + 2] = xs + t * after;
    next[tail + 3] = after;
    return next;
  }

  [[nodiscard]] Eigen::MatrixXd matrix() const {
    Eigen::MatrixXd m(size(), size());
    for (Eigen::Index i = 0; i < size(); ++i) m.col(i) = tick(Eigen::VectorXd::Unit(size(), i));
    return m;
  }

 private:
  AxisLoop l_;
  Termination t_;
  Eigen::Index moving_;
  Eigen::MatrixXd held_;
};

inline bool swings(AxisLoop l, const Termination& t, double damping) {
  constexpr double kRounding = 1e-10;  // of a radius
  l.damping = damping;
  return spectralRadius(TerminatedAxis(l, t).matrix()) > 1.0 + kRounding;
}

/// Device damping below which the loop oscillates, by bisection of the radius; 0: it never does.
inline double boundary(const AxisLoop& l, const Termination& t, int halvings) {
  double low = 0.5 * t.most, high = 1.1 * t.most;
  if (!swings(l, t, low)) return 0.0;
  if (swings(l, t, high)) return std::numeric_limits<double>::infinity();
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (swings(l, t, middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace wholehand::test
