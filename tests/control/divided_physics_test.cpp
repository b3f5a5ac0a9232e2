// Physics at a divisor of the rate: the matrix of the loop, and b_min, which is exact there, too.
#include "axis_loop.hpp"
#include "control/coupled_passivity.hpp"
#include "control/passivity.hpp"
#include "divided_termination.hpp"
#include "random_loops.hpp"
#include "support/figure.hpp"

namespace wholehand::test {
namespace {

// A swing of more than 60 ticks grows so slowly there that rounding hides it.
constexpr double kSlow_rad = 0.1, kSlowSide = 0.1;
constexpr int kDividedHalvings = 14;  // of the interval about a boundary

AxisLoop randomLoop(Draw& draw) {
  AxisLoop l;
  l.mass = draw.between(0.05, 3.0);
  l.damping = draw.between(0.1, 20.0);
  l.physics_divisor = 2 + draw.upTo(6);
  l.delay_ticks = draw.upTo(3);
  l.period_s = 1e-3 / (1 << draw.upTo(3));
  l.k_pm = draw.between(100.0, 3000.0);
  l.phi_k_dm = draw.chance(0.2) ? 0.0 : draw.between(0.5, 20.0);
  l.gamma = draw.chance(0.15) ? 0.0 : draw.unit();
  l.filter_tau_s = 1.0 / (2.0 * std::numbers::pi * draw.between(15.0, 100.0));
  const double highest = std::min(4e4, 0.5 / (l.stepPeriod() * l.stepPeriod()));
  l.k_ps_per_s2 = draw.between(400.0, highest);
  l.k_ds_per_s = criticalDamping(l.k_ps_per_s2, l.stepPeriod());
  drawWall(l, draw);
  return l;
}

/// The tick of the test's person and object against the library's matrix, where that has both.
TEST(DividedPhysics, TerminatedAxis_IsTheLibrarysLoop) {
  Draw draw(81);
  for (int i = 0; i < 60; ++i) {
    AxisLoop l = randomLoop(draw);
    const Termination t = drawPersonAndObject(l, draw, i % 2 == 0);
    const auto contact = t.rigid ? ContactCase::kRigid : ContactCase::kObject;
    const double expected = spectralRadius(TerminatedAxis(l, t).matrix());
    EXPECT_NEAR(expected, spectralRadius(closedLoopMatrix(l, contact)), 1e-8 * expected);
  }
}

/// A pinned avatar has no part in the loop: the radius is that of the undivided one for every tick.
TEST(DividedPhysics, AgainstARigidStop_IsTheUndividedLoop) {
  Draw draw(82);
  for (int i = 0; i < 50; ++i) {
    AxisLoop l = randomLoop(draw);
    const double divided = spectralRadius(closedLoopMatrix(l, ContactCase::kRigid));
    const int divisor = std::exchange(l.physics_divisor, 1);
    const double each = spectralRadius(closedLoopMatrix(l, ContactCase::kRigid));
    EXPECT_NEAR(divided, std::pow(each, divisor), 1e-9 * divided);
  }
}

TEST(DividedPhysics, RandomLoops_SwingTwoPercentBelowAndNotAbove) {
  Draw draw(83);
  double least = HUGE_VAL, share = HUGE_VAL, most = 0.0, short_of = 0.0;
  int judged = 0, number = 0;
  for (const int wanted = cases(40); number < wanted; ++number) {
    AxisLoop l = randomLoop(draw);
    const double required = requiredDamping(l);
    if (!(required > 0.01)) continue;  // its own damping does
    // The mass plays no part in b_min: a light one, with which 2 % shows well above rounding.
    l.mass = draw.between(10.0, 100.0) * required * l.period_s;
    const Termination t = worstDivided(l);
    short_of = std::max(short_of, t.most / required - 1.0);
    if (!isPassive(t)) continue;  // not built
    ++judged;
    const double at = boundary(l, t, kDividedHalvings) / required;
    least = std::min(least, at);
    most = std::max(most, at);
    share = std::min(share, t.needed / required);
    const double side = t.angle_rad < kSlow_rad ? kSlowSide : kSide;
    EXPECT_GE(at, (1.0 - side) * t.needed / required) << "loop " << number;
    EXPECT_LE(at, 1.0 + 1e-5) << "loop " << number;
  }
  figure("random loops with physics at a divisor, with their worst person and object", judged,
         "loops");
  figure("damping at which these begin to swing, of b_min, least", least, "");
  figure("the same, most", most, "");
  figure("b_min at the frequency of these, of b_min, least", share, "");
  figure("b_min short of what one of the swept frequencies needs, most", short_of, "");
  EXPECT_GE(2 * judged, number);
  EXPECT_LE(short_of, 1e-6) << "a guarantee is never less than the truth";
}

/// The criterion of all axes with one axis is b_min, and passes on to more axes: it is never less
/// than what each of them needs.
TEST(DividedPhysics, CoupledCriterionOfOneAxis_IsTheDampingRequired) {
  Draw draw(84);
  for (int number = 0; number < 40; ++number) {
    const CertifiedSet set = certifiedSet(draw, 2 + draw.upTo(6));
    CoupledCase c;
    c.axes = {set.gains};
    c.delay_ticks = set.gains.delay_ticks;
    c.period_s = set.gains.period_s;
    c.physics_divisor = set.gains.physics_divisor;
    c.inertias = {AxisMatrix::Constant(1, 1, set.gains.inertia + set.gains.armature())};
    double expected = 0.0;
    for (const double phi : {0.0, 1.0}) {
      for (const double alpha : {0.0, 1.0}) {
        expected = std::max(expected, requiredDamping(set.gains.loopIn(set.wall(), alpha, phi)));
      }
    }
    const double found = requiredShare(c).share * set.gains.axis.damping;
    // Near rest 1 - cos φ leaves 5 digits of either.
    EXPECT_NEAR(found, expected, 1e-4 * expected) << "set " << number;
  }
}

}  // namespace
}  // namespace wholehand::test
