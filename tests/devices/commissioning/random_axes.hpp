#pragma once

#include "devices/commissioning/identification/identify_axis.hpp"
#include "loop/device/simulated/axis_dynamics.hpp"
#include "mechanism.hpp"
#include "support/seed.hpp"

/// Random axes, and the traces that commissioning would record of them on a simulated clock.
namespace wholehand::test {

struct RandomAxis {
  MechanismAxis plant, neighbour;
  double effort_limit = 0.0;  ///< of the device file
  double stated_mass = 0.0;   ///< of the device file: wrong by up to 40 %
  double cross_inertia = 0.0;
};

/// Draws axes of the size of haptic devices: 0.1 to 2 kg, 15 to 60 m/s² at the effort limit, time
/// constants of 25 to 330 ms, dry friction of 0.3 to 3 % of the limit, up to 3 periods of delay.
class AxisDraw {
 public:
  explicit AxisDraw(unsigned stream) : random_(seededRandom(stream)) {}
  double unit() { return uniform_(random_); }
  /// Draws evenly on a logarithmic scale.
  double between(double low, double high) { return low * std::pow(high / low, unit()); }

  RandomAxis ideal() {
    RandomAxis out;
    MechanismAxis& p = out.plant;
    const double range = between(0.1, 0.3);
    p.lower = -0.5 * range;
    p.upper = 0.5 * range;
    p.mass = between(0.1, 2.0);
    out.effort_limit = p.mass * between(15.0, 60.0) * range / 0.2;
    out.stated_mass = p.mass * between(0.7, 1.4);
    p.damping = p.mass * between(3.0, 40.0);
    p.coulomb = out.effort_limit * between(0.003, 0.03);
    p.gravity = out.effort_limit * 0.05 * (2.0 * unit() - 1.0);
    p.step = range / between(5000.0, 50000.0);
    p.delay_s = 3e-3 * unit();
    out.neighbour = p;
    out.neighbour.mass = p.mass * between(0.3, 3.0);
    return out;
  }

  /// An axis with disturbances. Stribeck friction falls over 0.5 to 5 % of the speed that a fifth
  /// of the limit reaches in 0.05 s; cogging is 0.2 to 2 % of the limit; play is 0.02 to 0.5 % of
  /// the range before 5 to 50 % of the mass; a neighbour is coupled by 5 % of the inertia.
  RandomAxis disturbed(bool stribeck, bool cogging, bool play) {
    RandomAxis out = ideal();
    MechanismAxis& p = out.plant;
    const double range = p.upper - p.lower;
    if (stribeck) {
      p.breakaway = p.coulomb * between(0.1, 1.0);
      p.stribeck_speed = 0.05 * 0.2 * out.effort_limit / p.mass * between(0.005, 0.05);
    }
    if (cogging) {
      p.cogging = out.effort_limit * between(0.002, 0.02);
      p.cogging_pitch = range / between(5.0, 50.0);
    }
    if (play) {
      p.play = range * between(2e-4, 5e-3);
      p.load_share = between(0.05, 0.5);
    }
    if (stribeck && cogging && play) out.cross_inertia = 0.05;
    return out;
  }

 private:
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

inline ExcitationPlan planFor(const RandomAxis& axis, double period_s) {
  ExcitationPlan plan;
  plan.period_s = period_s;
  plan.lower = axis.plant.lower;
  plan.upper = axis.plant.upper;
  plan.mass = axis.stated_mass;
  plan.effort_limit = 0.2 * axis.effort_limit;
  plan.offset = axis.plant.gravity;
  return plan;
}

/// Trace by the exact solution of device/simulated, for ideal axes only.
inline AxisTrace traceOfIdeal(const RandomAxis& axis, double period_s) {
  const MechanismAxis& p = axis.plant;
  AxisPlant plant;
  plant.mass = p.mass;
  plant.damping = p.damping;
  plant.coulomb = p.coulomb;
  plant.lower = p.lower;
  plant.upper = p.upper;
  const auto whole = static_cast<std::size_t>(p.delay_s / period_s);
  const double broken_s = p.delay_s - static_cast<double>(whole) * period_s;
  // In each period the older command still acts for the fractional part of the delay.
  AxisDynamics older(plant, broken_s), newer(plant, period_s - broken_s);
  Excitation excitation(planFor(axis, period_s));
  AxisTrace trace;
  trace.period_s = period_s;
  const auto acting = [&](std::size_t back) {
    const std::size_t n = trace.effort.size();
    return back < n ? trace.effort[n - 1 - back] - p.gravity : 0.0;
  };
  while (!excitation.done()) {
    trace.posture.push_back(excitation.posture());
    trace.position.push_back(std::round(newer.position() / p.step) * p.step);
    trace.effort.push_back(excitation.next(trace.position.back()));
    older.place(newer.position(), newer.velocity());
    older.advance({acting(whole + 1), acting(whole + 1)});
    newer.place(older.position(), older.velocity());
    newer.advance({acting(whole), acting(whole)});
  }
  return trace;
}

/// A trace, and the true times of its ticks.
struct UnevenTrace {
  AxisTrace trace;
  std::vector<double> taken_s;
};

/// Trace of the same axis on a machine that is late in a share of its ticks, by 0.25 to 2 periods;
/// the next tick is on time again if possible (as RealTicks).
inline UnevenTrace unevenTraceOf(const RandomAxis& axis, double period_s, double late_share,
                                 AxisDraw& draw) {
  constexpr int kQuarters = 4;
  Mechanism mechanism({axis.plant, axis.neighbour}, period_s / kQuarters);
  mechanism.place(1, 0.0);
  Excitation excitation(planFor(axis, period_s));
  UnevenTrace out;
  out.trace.period_s = period_s;
  long now = 0, planned = 0;  // quarters of a period
  while (!excitation.done()) {
    out.taken_s.push_back(static_cast<double>(now) * period_s / kQuarters);
    out.trace.posture.push_back(excitation.posture());
    out.trace.position.push_back(mechanism.position(0));
    out.trace.effort.push_back(excitation.next(mechanism.position(0)));
    planned = planned + kQuarters > now - kQuarters ? planned + kQuarters : now + kQuarters;
    const bool late = draw.unit() < late_share;
    const long next =
        std::max(now + 1, planned) + (late ? 1 + static_cast<long>(8 * draw.unit()) : 0);
    for (; now < next; ++now) mechanism.advance({out.trace.effort.back(), axis.neighbour.gravity});
  }
  return out;
}

/// Trace by the test's own Mechanism, with a neighbour at rest.
inline AxisTrace traceOf(const RandomAxis& axis, double period_s) {
  Mechanism mechanism({axis.plant, axis.neighbour}, period_s);
  mechanism.cross_inertia = axis.cross_inertia;
  mechanism.place(1, 0.0);
  Excitation excitation(planFor(axis, period_s));
  AxisTrace trace;
  trace.period_s = period_s;
  while (!excitation.done()) {
    trace.posture.push_back(excitation.posture());
    trace.position.push_back(mechanism.position(0));
    trace.effort.push_back(excitation.next(mechanism.position(0)));
    mechanism.advance({trace.effort.back(), axis.neighbour.gravity});
  }
  return trace;
}

}  // namespace wholehand::test
