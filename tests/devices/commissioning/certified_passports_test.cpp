// Measures random true axes and renders gains on each of them whose certificate holds at the worst
// corners of the measured intervals. Persons and objects are random and passive. No loop may become
// unstable. The loop is that of tests/loop/control (AxisSimulation).
#include "certify/certified_sets.hpp"
#include "devices/commissioning/identification/identify_axis.hpp"
#include "devices/passport/passport.hpp"
#include "loop/control/axis_simulation.hpp"
#include "random_axes.hpp"
#include "support/constants.hpp"
#include "support/figure.hpp"

#include <optional>

namespace wholehand::test {
namespace {

constexpr int kTicks = 4000;

// The stiffest gains of a fixed series whose certificate holds at every corner; none if no gains
// do.
std::optional<AxisCase> certifiedGains(const DeviceModel& file, const Passport& passport,
                                       AxisDraw& draw) {
  AxisCase c;
  c.axis = file.axes[0];
  c.period_s = kPeriod_s;
  c.gains.name = "x";
  c.gains.gamma = draw.unit();
  c.gains.velocity_filter_hz = draw.between(15.0, 100.0);
  c.inertia = draw.between(0.1, 1.0);
  for (double k_pm = 20000.0; k_pm > 20.0; k_pm *= 0.8) {
    c.gains.k_pm = k_pm;
    bool all = true;
    for (const DeviceModel& corner : worstCorners(file, passport, kPeriod_s)) {
      AxisCase at = c;
      at.axis = corner.axes[0];
      at.delay_ticks = corner.output_delay_ticks;
      all = all && holds(at);
    }
    if (all) return c;
  }
  return std::nullopt;
}

DeviceModel fileOf(const RandomAxis& axis) {
  DeviceModel model;
  DeviceAxis a;
  a.name = "x";
  a.lower = axis.plant.lower;
  a.upper = axis.plant.upper;
  a.effort_limit = axis.effort_limit;
  a.speed_limit = 1.5;
  a.effort_slew_limit = 1e6;
  a.mass = axis.stated_mass;             // wrong by up to 40 %
  a.damping = 4.0 * axis.plant.damping;  // states more damping than there is
  a.coulomb = 2.0 * axis.plant.coulomb;
  model.axes = {a};
  return model;
}

Passport passportOf(const IdentifiedAxis& found) {
  Passport passport;
  PassportAxis axis;
  axis.name = "x";
  axis.mass = found.mass;
  axis.damping = found.damping;
  axis.coulomb = found.coulomb;
  axis.delay_s = found.delay_s;
  axis.resolution = found.resolution;
  passport.axes = {axis};
  return passport;
}

// The true axis with these gains, a random person, and an avatar in random contact.
AxisSimulation sceneOf(const RandomAxis& axis, AxisCase gains, int delay_ticks, AxisDraw& draw) {
  gains.axis.mass = axis.plant.mass;
  gains.axis.damping = axis.plant.damping;
  gains.delay_ticks = delay_ticks;
  AxisLoop l = gains.loop(draw.unit());
  if (draw.unit() < 0.7) {
    l.person = {draw.between(0.05, 10.0), draw.between(0.1, 50.0), draw.between(10.0, 5000.0)};
  }
  const double kind = draw.unit();
  const ContactCase contact = kind < 0.25  ? ContactCase::kFree
                              : kind < 0.6 ? ContactCase::kRigid
                                           : ContactCase::kObject;
  if (contact == ContactCase::kObject) {
    l.held_mass = draw.between(0.01, 100.0);
    l.spring_per_s2 = draw.unit() < 0.3 ? 0.0 : draw.between(10.0, 1e6);
  }
  AxisSimulation simulation(l, contact);
  simulation.start(0.02 * (2.0 * draw.unit() - 1.0), 1.0 * (2.0 * draw.unit() - 1.0));
  return simulation;
}

TEST(CertifiedPassports, GainsCertifiedFromPassports_AreStableOnRandomTrueAxes) {
  AxisDraw draw(421);
  int certified = 0, unstable = 0, hopeless = 0;
  double most_growth = 0.0;
  const int count = cases(34);
  for (int i = 0; i < count; ++i) {
    const RandomAxis axis = draw.ideal();
    const IdentifiedAxis found = orThrow(identifyAxis(traceOfIdeal(axis, kPeriod_s), "x"));
    const auto gains = certifiedGains(fileOf(axis), passportOf(found), draw);
    hopeless += gains ? 0 : 1;
    if (!gains) continue;
    ++certified;
    // The simulation knows whole periods of delay only: the true delay lies between the two
    // simulated ones.
    const double delay = axis.plant.delay_s / kPeriod_s;
    const int upper = static_cast<int>(std::ceil(delay - 0.1));
    for (const int ticks : {static_cast<int>(std::floor(delay)), upper}) {
      AxisSimulation loop = sceneOf(axis, *gains, ticks, draw);
      double first = 0.0, second = 0.0;
      for (int k = 0; k < 2 * kTicks; ++k) {
        loop.tick();
        double& half = k < kTicks ? first : second;
        half = std::max(half, loop.energy());
      }
      most_growth = std::max(most_growth, second / first);
      if (second <= first) continue;
      ++unstable;
      ADD_FAILURE() << "axis " << i << " at " << ticks << " periods: " << first << " J, then "
                    << second << " J";
    }
  }
  figure("true axes certified from their passports", certified, "");
  figure("of them unstable", unstable, "");
  figure("largest energy of the second four seconds over the first", most_growth, "");
  EXPECT_EQ(unstable, 0);
  // At most a fifth may remain uncertified, plus three standard deviations for so few draws.
  EXPECT_LE(hopeless, 0.2 * count + 3.0 * std::sqrt(0.2 * 0.8 * count))
      << "intervals so wide that nothing is certified prove nothing";
}

// Shows that the corners are needed: with the file's own figures, the same search finds unstable
// gains.
TEST(CertifiedPassports, GainsCertifiedFromTheFileAlone_AreUnstable) {
  AxisDraw draw(422);
  int unstable = 0;
  for (int i = 0; i < 20; ++i) {
    const RandomAxis axis = draw.ideal();
    const DeviceModel file = fileOf(axis);
    Passport believed = passportOf(IdentifiedAxis{});
    const DeviceAxis& a = file.axes[0];
    believed.axes[0].mass = {a.mass, a.mass};
    believed.axes[0].damping = {a.damping, a.damping};
    believed.axes[0].coulomb = {a.coulomb, a.coulomb};
    const auto gains = certifiedGains(file, believed, draw);
    if (!gains) continue;
    AxisCase true_axis = *gains;
    true_axis.axis.mass = axis.plant.mass;
    true_axis.axis.damping = axis.plant.damping;
    true_axis.delay_ticks = static_cast<int>(std::ceil(axis.plant.delay_s / kPeriod_s));
    bool swings = false;
    for (const ContactCase contact : {ContactCase::kRigid, ContactCase::kFree}) {
      swings = swings || swingsWider(AxisSimulation(true_axis.loop(0.0), contact), 20000);
    }
    unstable += swings ? 1 : 0;
  }
  figure("unstable with the file's own promises, of 20", unstable, "axes");
  EXPECT_GE(unstable, 3) << "the test above would not show it";
}

}  // namespace
}  // namespace wholehand::test
