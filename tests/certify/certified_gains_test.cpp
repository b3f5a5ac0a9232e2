// Random certified gains with random passive persons and objects: no loop becomes unstable, and the
// loop gives out no more energy than was put in and stored.
#include "certified_sets.hpp"
#include "loop/control/axis_simulation.hpp"
#include "support/figure.hpp"

namespace wholehand::test {
namespace {

constexpr int kCertifiedTicks = 4000;

/// A set of gains with a random person and object, in motion.
AxisSimulation randomScene(const CertifiedSet& set, Draw& draw) {
  AxisLoop l = set.gains.loopIn(set.wall(), draw.chance(0.5) ? 1.0 : draw.unit(), set.phi);
  if (draw.chance(0.7)) {
    l.person = {draw.chance(0.2) ? 0.0 : draw.between(0.05, 10.0),
                draw.chance(0.3) ? 0.0 : draw.between(0.1, 50.0),
                draw.chance(0.3) ? 0.0 : draw.between(10.0, 5000.0)};
  }
  const double kind = draw.unit();
  const ContactCase contact = kind < 0.25  ? ContactCase::kFree
                              : kind < 0.5 ? ContactCase::kRigid
                                           : ContactCase::kObject;
  if (contact == ContactCase::kObject) {
    l.held_mass = draw.chance(0.3) ? 0.0 : draw.between(0.01, 100.0);
    l.spring_per_s2 = draw.chance(0.3) ? 0.0 : draw.between(10.0, 1e6);
  }
  AxisSimulation axis(l, contact);
  axis.wall_linear = false;
  axis.wall_at = 0.01 * (2.0 * draw.unit() - 1.0);
  axis.start(0.05 * (2.0 * draw.unit() - 1.0), 1.5 * (2.0 * draw.unit() - 1.0));
  return axis;
}

TEST(CertifiedGains, RandomPassivePersonsAndObjects_AreStable) {
  Draw draw(72);
  int unstable = 0, number = 0;
  double most_growth = 0.0;
  for (const CertifiedSet& set : certifiedSets()) {
    AxisSimulation axis = randomScene(set, draw);
    double first = 0.0, second = 0.0;
    for (int k = 0; k < 2 * kCertifiedTicks; ++k) {
      axis.tick();
      (k < kCertifiedTicks ? first : second) =
          std::max(k < kCertifiedTicks ? first : second, axis.energy());
    }
    ++number;
    most_growth = std::max(most_growth, second / first);
    if (!(second <= first)) {
      ++unstable;
      ADD_FAILURE() << "set " << number << ": " << first << " J, then " << second << " J";
    }
  }
  EXPECT_EQ(unstable, 0);
  figure("certified sets with passive persons and objects", number, "sets");
  figure("largest energy of the second four seconds over the first", most_growth, "");
}

/// Energy balance of one axis, in rendered units. The two ports of the loop are the device's handle
/// and the avatar's inertia. Until tick k
///   given(k) = Σ f Δx_m                 work of the effort that acted, on device and person
///             + Σ σ′a Δx_s               work of the avatar's drive, on avatar and object
///             − ∫ b v² dt                loss in the device's own damping, a part of the loop
/// is the energy that the loop gave out beyond what was put into it. It must come from the stored
/// energy:
///   given(k) <= S(0) − S(k),        S = K_pm e²/2 + αk p²/2.
/// A tank of capacity Ê lets an unstable loop continue until it owes that much.
/// The axis starts at rest and unstretched, as rendering does: the energy comes from a person's
/// push.
struct Push {
  double effort = 0.0;
  int ticks = 0;
};

struct Balance {
  double worst_j = 0.0;  ///< the largest given(k) + S(k) − S(0)
  double tank_work_j = 0.0;
};

Balance balanceOf(AxisSimulation axis, const Push& push, bool with_tank) {
  const AxisLoop& l = axis.l;
  const CouplingGains gains = gainsOf(l);
  EnergyTankConfig config = tankOf(l);
  EnergyTankState tank = fullTank(config);
  const AxisEffort no_limit(1, 1e9);
  const double mass = l.mass + l.person.mass;
  const double share = l.damping / (l.damping + l.person.damping);
  axis.start(0.0, 0.0);
  axis.wall_at = std::abs(axis.wall_at);
  const auto stored = [&] {
    const double e = axis.x - axis.xs, depth = std::max(0.0, axis.x - axis.wall_at);
    return 0.5 * l.k_pm * e * e + 0.5 * l.wall_stiffness * depth * depth;
  };
  const auto moving = [&] {
    return 0.5 * mass * axis.v * axis.v + 0.5 * l.person.stiffness * axis.x * axis.x;
  };
  Balance out;
  const double begun = stored();
  double given = 0.0;
  for (int k = 0; k < kCertifiedTicks; ++k) {
    const AxisPosition q_m(1, axis.x), q_s(1, axis.xs);
    const double depth = std::max(0.0, axis.x - axis.wall_at);
    const AxisEnergy wall(1, 0.5 * l.wall_stiffness * depth * depth);
    double effort = 0.0;
    if (with_tank) {
      const EnergyTankStep step =
          advanceTank(tank, q_m, q_s, wall, {}, gains, config, no_limit, 1, l.period_s);
      tank = step.state;
      effort = step.effort[0];
    }
    const double x = axis.x, xs = axis.xs, before = moving();
    const double pushed = k < push.ticks ? push.effort : 0.0;
    axis.tick(effort, pushed);
    if (with_tank) {
      tank =
          recordSent(tank, AxisEffort(1, axis.sent()), AxisEffort(1, axis.avatarDrive()), no_limit);
    }
    const double on_device = axis.felt() * (axis.x - x);
    const double taken = share * (on_device + pushed * (axis.x - x) - (moving() - before));
    given += on_device + axis.avatarDrive() * (axis.xs - xs) - taken;
    out.worst_j = std::max(out.worst_j, given + stored() - begun);
    out.tank_work_j += std::abs(effort * (axis.x - x));
  }
  return out;
}

TEST(CertifiedGains, RandomPassivePersonsAndObjects_ReceiveNoMoreThanWasPutInAndStored) {
  Draw draw(73);
  double worst = 0.0, without = 0.0, uncertified = 0.0;
  int touched = 0, number = 0;
  for (const CertifiedSet& set : certifiedSets()) {
    const AxisSimulation axis = randomScene(set, draw);
    const double capacity = tankOf(axis.l).capacity[0];
    const Push push{draw.between(1.0, 20.0) * (draw.chance(0.5) ? 1.0 : -1.0), draw.upTo(500) + 50};
    const Balance balance = balanceOf(axis, push, true);
    const Balance alone = balanceOf(axis, push, false);
    worst = std::max(worst, balance.worst_j);
    without = std::max(without, alone.worst_j);
    AxisLoop slippery = axis.l;
    slippery.damping *= 0.2;
    const AxisSimulation gives(slippery, ContactCase::kRigid);
    uncertified = std::max(uncertified, balanceOf(gives, push, false).worst_j / capacity);
    touched += balance.tank_work_j > 0.0 ? 1 : 0;
    EXPECT_LE(balance.worst_j, tolerance(1e-9)) << "set " << number;
    EXPECT_LE(alone.worst_j, tolerance(1e-9)) << "set " << number << ", without the tank";
    ++number;
  }
  figure("energy put out beyond what was put in and the springs stored", worst, "J");
  figure("the same without a tank", without, "J");
  figure("sets in which the tank had to damp", touched, "sets");
  figure("the same without a tank on devices of a fifth of the damping, of a tank's, at least",
         std::min(uncertified, 1e6), "");
  EXPECT_EQ(touched, 0) << "a stable loop is left alone";
  if (kStatisticsMeaningful) {
    EXPECT_GT(uncertified, 1.0) << "the balance would not show it";
  }
}

/// Throws a device that nobody holds at its speed limit against an avatar that a stop holds.
/// @return largest speed of the rebound within the next two seconds
double reboundSpeed(const CertifiedSet& set, double phi, double slew_per_s) {
  AxisSimulation axis(set.gains.loopIn(set.wall(), 1.0, phi), ContactCase::kRigid);
  axis.wall_linear = false;
  axis.fly(set.gains.axis.speed_limit);
  axis.most_change = slew_per_s * axis.l.period_s;
  double fastest = 0.0;
  for (int k = 0; k < kCertifiedTicks / 2; ++k) {
    axis.tick();
    fastest = std::max(fastest, -axis.v);
  }
  return fastest;
}

TEST(CertifiedGains, SlewThatTheCertificateRequires_IsEnoughAndHalfOfItIsNot) {
  double worst = 0.0, half = 0.0;
  for (const CertifiedSet& set : certifiedSets()) {
    const double required = requiredSlew(set.gains);
    for (const double phi : {0.0, 1.0}) {
      const double free = reboundSpeed(set, phi, HUGE_VAL);
      const double speed = set.gains.axis.speed_limit;
      worst = std::max(worst, (reboundSpeed(set, phi, required) - free) / speed);
      half = std::max(half, (reboundSpeed(set, phi, 0.5 * required) - free) / speed);
    }
  }
  figure("rebound that the required slew adds, of the speed limit", worst, "");
  figure("rebound that half of it adds", half, "");
  EXPECT_LE(worst, 0.1);  // 7 % is about what a person notices
  EXPECT_GE(half, 1.0) << "comes back faster than it went";
}

}  // namespace
}  // namespace wholehand::test
