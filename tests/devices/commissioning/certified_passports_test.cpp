// Random true axes are measured; gains that hold their certificate at the worst corners of what was
// measured are then rendered on the true axis, with random passive persons and objects: none
// becomes unstable. The loop is that of tests/loop/control (AxisSimulation).
#include "certify/certified_sets.hpp"
#include "devices/commissioning/identification/identify_axis.hpp"
#include "devices/commissioning/passport.hpp"
#include "loop/control/axis_simulation.hpp"
#include "random_axes.hpp"
#include "support/constants.hpp"
#include "support/figure.hpp"

#include <optional>

namespace wholehand::test {
namespace {

constexpr int kTicks = 4000;

// The stiffest gains on a fixed ladder that hold at every corner; nothing: none do.
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
  a.damping = 4.0 * axis.plant.damping;  // promises what is not there
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

// The true axis under these gains, held by somebody, its avatar touching something.
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

TEST(CertifiedPassports, OfRandomTrueAxes_AreNeverUnstable) {
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
    // A simulation of whole delays: the true one lies between its two neighbours.
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
  // A fifth at most, and what so few draws may differ by: three standard deviations.
  EXPECT_LE(hopeless, 0.2 * count + 3.0 * std::sqrt(0.2 * 0.8 * count))
      << "intervals so wide that nothing is certified prove nothing";
}

// What the corners are for: with the file's own promises the same search finds gains that swing.
TEST(CertifiedPassports, TheFilesOwnPromises_WouldHaveBeenUnstable) {
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
