// b_min is exact: for every row of the reference's table and for random loops, a passive person and
// a passive object are built with which the loop oscillates at 2 % less damping, and none makes it
// oscillate above b_min.
#include "certified_sets.hpp"
#include "certify/passivity.hpp"
#include "loop/control/axis_loop.hpp"
#include "support/figure.hpp"
#include "worst_termination.hpp"

#include <Eigen/Eigenvalues>

namespace wholehand::test {
namespace {

constexpr int kHalvings = 18;  // of the interval around a boundary

AxisLoop lightLoop(double k_ps, int delay, double filter_hz, double gamma) {
  return loopOf(0.5, 0.0, delay, 1000.0, 0.0, filter_hz, k_ps, gamma);
}

/// The table of b_min at K_pm 1000 N/m and 30 Hz, and the filter that makes γ costly.
std::vector<AxisLoop> tableOfLoops() {
  std::vector<AxisLoop> out;
  for (const auto& [k_ps, delay, filter_hz] : {std::tuple{900.0, 1, 30.0},
                                               {2500.0, 0, 30.0},
                                               {2500.0, 1, 30.0},
                                               {1e4, 0, 30.0},
                                               {1e4, 1, 30.0},
                                               {4e4, 1, 30.0},
                                               {2500.0, 1, 100.0}}) {
    for (const double gamma : {0.0, 0.5, 1.0}) {
      out.push_back(lightLoop(k_ps, delay, filter_hz, gamma));
    }
  }
  return out;
}

std::string nameOf(const AxisLoop& l) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "K_ps %g n %d γ %g filter %.0f Hz", l.k_ps_per_s2,
                l.delay_ticks, l.gamma, 1.0 / (2.0 * std::numbers::pi * l.filter_tau_s));
  return text.data();
}

struct Range {
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  void take(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

TEST(RequiredDampingFigures, EveryRowOfTheTable_OscillatesTwoPercentBelowAndNotAbove) {
  Range at;
  for (const AxisLoop& l : tableOfLoops()) {
    const double required = requiredDamping(l);
    const Termination t = worstTermination(l, World::kLossless);
    ASSERT_TRUE(isPassive(t)) << nameOf(l);
    // Computed over the boundary of passive terminations, not by the closed form of absolute
    // stability.
    EXPECT_NEAR(t.most, required, 1e-4 * required) << nameOf(l);
    EXPECT_TRUE(swings(l, t, (1.0 - kSide) * required)) << nameOf(l);
    EXPECT_FALSE(swings(l, t, (1.0 + kSide) * required)) << nameOf(l);
    at.take(boundary(l, t, kHalvings) / required);
  }
  figure("damping at which the worst person and object begin to swing, of b_min, least", at.least,
         "");
  figure("the same, most", at.most, "");
  EXPECT_GE(at.least, 1.0 - tolerance(kSide));
  EXPECT_LE(at.most, 1.0 + 1e-6) << "b_min is less than what is needed";
}

/// A random loop: wall, Φ, filter, delay and rate.
AxisLoop loopOfAnyRate(Draw& draw) {
  AxisLoop l = lightLoop(400.0, draw.upTo(3), draw.between(15.0, 100.0),
                         draw.chance(0.15) ? 0.0 : draw.unit());
  l.k_pm = draw.between(100.0, 3000.0);
  l.phi_k_dm = draw.chance(0.2) ? 0.0 : draw.between(0.5, 20.0);
  l.period_s = 1e-3 / (1 << draw.upTo(3));
  l.k_ps_per_s2 = draw.between(400.0, 4e4);
  l.k_ds_per_s = criticalDamping(l.k_ps_per_s2, l.period_s);
  if (draw.chance(0.3)) {
    l.wall_stiffness = draw.between(0.05, 0.5) * l.k_pm;
    l.wall_damping = draw.chance(0.3) ? 0.0 : draw.unit();
  }
  return l;
}

TEST(RequiredDampingFigures, RandomLoops_OscillateTwoPercentBelowAndNotAbove) {
  Draw draw(74);
  Range at;
  double short_of = 0.0;
  int number = 0, judged = 0;
  const int wanted = cases(60);
  for (; number < wanted; ++number) {
    AxisLoop l = loopOfAnyRate(draw);
    const double required = requiredDamping(l);
    if (!(required > 0.01)) continue;  // its own damping is enough
    // b_min does not depend on the mass; a light mass makes 2 % show well above rounding.
    l.mass = draw.between(10.0, 100.0) * required * l.period_s;
    const Termination t = worstTermination(l, World::kLossless);
    ASSERT_TRUE(isPassive(t)) << "loop " << number;
    ++judged;
    at.take(boundary(l, t, kHalvings) / required);
    EXPECT_GE(at.least, 1.0 - kSide) << "loop " << number;
    EXPECT_LE(at.most, 1.0 + 1e-5) << "loop " << number;
    short_of = std::max(short_of, t.most / required - 1.0);
  }
  figure("random loops with their worst person and object", judged, "loops");
  figure("damping at which these begin to swing, of b_min, least", at.least, "");
  figure("the same, most", at.most, "");
  figure("b_min short of what one of the swept frequencies needs, most", short_of, "");
  EXPECT_LE(short_of, 1e-9) << "a guarantee is never less than the truth";
}

/// Oscillation whose frequency the sampling cannot distinguish from its images. A person with one
/// resonance responds to only one of them and needs the share (sin φ/2 / φ/2)² of b_min less the
/// contribution of the other images. At Nyquist, where an oscillation is its own image, the share
/// is twice that, 8/π².
TEST(RequiredDampingFigures, PersonWithOneResonance_NeedsOnlyTheirShareOfTheImages) {
  Range nyquist, below;
  for (const AxisLoop& l : tableOfLoops()) {
    const Termination t = worstTermination(l, World::kLossless, 0);
    const double half = 0.5 * t.angle_rad, weight = std::pow(std::sin(half) / half, 2.0);
    if (t.angle_rad < 0.1) continue;  // images contribute almost nothing
    const bool own_image = t.angle_rad > 3.14;
    const double share = boundary(l, t, kHalvings) / t.needed;
    EXPECT_NEAR(share, own_image ? 2.0 * weight : weight, 0.005) << nameOf(l);
    (own_image ? nyquist : below).take(share);
  }
  EXPECT_NEAR(nyquist.least, 8.0 / (std::numbers::pi * std::numbers::pi), 1e-3);
  figure("of b_min that a person with one resonance needs, at Nyquist", nyquist.least, "");
  figure("the same elsewhere, least", below.least, "");
  figure("the same elsewhere, most", below.most, "");
}

/// An implicit engine damps fast oscillations, so its objects need slightly less damping.
TEST(RequiredDampingFigures, ObjectsOfTheEngine_NeedAlmostAsMuch) {
  Range share, at;
  for (const AxisLoop& l : tableOfLoops()) {
    const double required = requiredDamping(l);
    const Termination t = worstTermination(l, World::kEngine);
    ASSERT_TRUE(isPassive(t)) << nameOf(l);
    EXPECT_LE(t.most, (1.0 + 1e-6) * required) << nameOf(l);
    EXPECT_TRUE(swings(l, t, (1.0 - kSide) * t.most)) << nameOf(l);
    EXPECT_FALSE(swings(l, t, (1.0 + kSide) * t.most)) << nameOf(l);
    at.take(boundary(l, t, kHalvings) / t.most);
    share.take(t.most / required);
    figure("b_min for the engine's objects, of b_min, " + nameOf(l), t.most / required, "");
  }
  figure("b_min for the engine's objects, of b_min, least", share.least, "");
  figure("damping at which the worst of these begin to swing, of theirs, least", at.least, "");
  figure("the same, most", at.most, "");
  EXPECT_GT(share.least, 0.95);
}

/// Rate per tick of the fastest growing or slowest decaying oscillation, simulated in time. Uses
/// two states a quarter of a cycle apart, whose sum of squares does not fluctuate.
double simulatedRate(const TerminatedAxis& axis) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(axis.matrix());
  Eigen::Index which = 0;
  solver.eigenvalues().cwiseAbs().maxCoeff(&which);
  const Eigen::VectorXcd swing = solver.eigenvectors().col(which);
  Eigen::VectorXd state = swing.real(), quarter = swing.imag();
  constexpr int kTicks = 20000;
  for (int k = 0; k < kTicks; ++k) {
    state = axis.tick(state);
    quarter = axis.tick(quarter);
  }
  return std::log(std::hypot(state.norm(), quarter.norm()) / swing.norm()) / kTicks;
}

TEST(RequiredDampingFigures, WorstTerminations_GrowAndDecayInTimeAsTheirRadiiSay) {
  double worst = 0.0;
  for (AxisLoop l : tableOfLoops()) {
    const Termination t = worstTermination(l, World::kLossless);
    for (const double side : {1.0 - kSide, 1.0 + kSide}) {
      l.damping = side * requiredDamping(l);
      const TerminatedAxis axis(l, t);
      const double predicted = std::log(spectralRadius(axis.matrix()));
      const double simulated = simulatedRate(axis);
      EXPECT_EQ(simulated > 0.0, side < 1.0) << nameOf(l);
      worst = std::max(worst, std::abs(simulated / predicted - 1.0));
    }
  }
  figure("rate of the worst terminations in time against their radii, worst", 100.0 * worst, "%");
  EXPECT_LT(worst, tolerance(kSide));
}

/// Gives the loop a person and an object that the library's matrix also has, and returns the same
/// as a termination.
Termination drawPersonAndObject(AxisLoop& l, Draw& draw, bool rigid) {
  l.person = {draw.between(0.1, 10.0), 0.0, draw.between(10.0, 5000.0)};
  Termination t;
  t.world = World::kEngine;
  t.mass = l.mass + l.person.mass;
  t.stiffness = l.person.stiffness;
  t.held_mass = l.held_mass = draw.between(0.01, 10.0);
  t.spring_per_s2 = l.spring_per_s2 = draw.between(10.0, 1e5);
  t.rigid = rigid;
  return t;
}

/// Compares the tick of this test with the library's matrix, where that has person and object.
TEST(RequiredDampingFigures, TerminatedAxis_EqualsTheLibrarysLoop) {
  Draw draw(75);
  for (int i = 0; i < 50; ++i) {
    AxisLoop l = loopOfAnyRate(draw);
    l.mass = draw.between(0.05, 3.0);
    l.damping = draw.between(0.1, 20.0);
    const Termination t = drawPersonAndObject(l, draw, i % 2 == 0);
    const auto contact = t.rigid ? ContactCase::kRigid : ContactCase::kObject;
    EXPECT_NEAR(spectralRadius(TerminatedAxis(l, t).matrix()),
                spectralRadius(closedLoopMatrix(l, contact)), 1e-9);
  }
}

}  // namespace
}  // namespace wholehand::test
