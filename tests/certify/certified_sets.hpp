#pragma once

#include "certify/certificate_refusal.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/control/energy_tank.hpp"
#include "support/seed.hpp"

#include <cmath>

/// Random gains that are certified.
namespace wholehand::test {

class Draw {
 public:
  explicit Draw(unsigned stream) : random_(seededRandom(stream)) {}
  double unit() { return uniform_(random_); }
  bool chance(double share) { return unit() < share; }
  /// Uniform on the logarithm.
  double between(double low, double high) { return low * std::pow(high / low, unit()); }
  int upTo(int most) { return std::min(most, static_cast<int>(unit() * (most + 1))); }

 private:
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

struct CertifiedSet {
  AxisCase gains;
  double phi = 0.0;  ///< of its adaptive damping
  [[nodiscard]] WallCase wall() const { return gains.walls.empty() ? WallCase{} : gains.walls[0]; }
};

/// A random device axis, its gains and sometimes a wall. Its damping is slightly more than the
/// certificate requires, and holds() accepts it.
inline CertifiedSet certifiedSet(Draw& draw) {
  for (;;) {
    CertifiedSet set;
    AxisCase& c = set.gains;
    c.axis.name = "x";
    c.axis.mass = draw.between(0.1, 3.0);
    c.axis.effort_limit = 20.0;
    c.axis.speed_limit = 1.5;
    c.delay_ticks = draw.upTo(3);
    c.gains.name = "x";
    c.gains.k_pm = draw.between(100.0, 3000.0);
    c.gains.k_dm = draw.chance(0.2) ? 0.0 : draw.between(0.5, 20.0);
    c.gains.gamma = draw.chance(0.15) ? 0.0 : draw.unit();
    c.gains.velocity_filter_hz = draw.between(15.0, 100.0);
    if (draw.chance(0.5)) {
      c.inertia = draw.between(0.1, 1.0);
    } else {
      c.inertia = c.gains.k_pm / draw.between(400.0, 4e4);  // k_p over the whole range
      c.gains.armature = 0.0;
    }
    if (draw.chance(0.3)) {
      c.walls = {{draw.between(0.05, 0.5) * c.gains.k_pm, draw.chance(0.3) ? 0.0 : draw.unit()}};
    }
    double required = 0.0;
    for (const double alpha : {0.0, 1.0}) {
      required = std::max(required, largestRequiredDamping(c, set.wall(), alpha).damping);
    }
    if (!std::isfinite(required)) continue;
    c.axis.damping = std::max(required, 0.01) * (1.0005 + 0.5 * draw.unit() * draw.unit());
    set.phi = draw.chance(0.3) ? 0.0 : draw.chance(0.4) ? 1.0 : draw.unit();
    if (holds(c)) return set;
  }
}

/// 10,200 sets with full counts, otherwise a sample by the seed; the same in every test.
inline const std::vector<CertifiedSet>& certifiedSets() {
  static const std::vector<CertifiedSet> kSets = [] {
    Draw draw(71);
    std::vector<CertifiedSet> sets;
    for (int i = 0; i < cases(340); ++i) sets.push_back(certifiedSet(draw));
    return sets;
  }();
  return kSets;
}

inline CouplingGains gainsOf(const AxisLoop& l) {
  CouplingGains g;
  g.axes = 1;
  g.k_pm = AxisStiffness(1, l.k_pm);
  g.k_dm = AxisDamping(1, l.phi_k_dm);
  g.gamma = AxisRatio(1, l.gamma);
  g.armature = AxisInertia(1, 0.0);
  g.inertia = AxisInertia(1, l.k_pm / l.k_ps_per_s2);
  g.filter_tau_s = AxisTime(1, l.filter_tau_s);
  return g;
}

/// D of the loop.
inline AxisDamping dampingOf(const AxisLoop& l) {
  return AxisDamping(1, l.k_pm * l.k_ds_per_s / l.k_ps_per_s2);
}

/// The shipped energy tank of a translation.
inline EnergyTankConfig tankOf(const AxisLoop& l) {
  DeviceModel device;
  device.output_delay_ticks = l.delay_ticks;
  DeviceAxis axis;
  axis.mass = l.mass;
  axis.damping = l.damping;
  axis.effort_limit = 20.0;
  device.axes.push_back(axis);
  // No energy here reaches 1 kJ: the hand's account is disabled, since it has its own tests.
  EnergyTankConfig config = makeEnergyTank(device, l.period_s);
  config.hand_capacity += 1e3;  // only the axes' tanks
  return config;
}

}  // namespace wholehand::test
