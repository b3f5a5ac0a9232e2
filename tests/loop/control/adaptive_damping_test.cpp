#include "loop/control/adaptive_damping.hpp"

#include "loop/realtime/allocation_counter.hpp"
#include "support/axes.hpp"
#include "support/constants.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

namespace wholehand::test {
namespace {

/// Algorithm 1 line by line as the paper prints it: f_d = 0, a stored peak and a running time.
struct PrintedAlgorithm {
  double peak = 0.0, t = 0.0, phi = 0.0;

  double update(double effort, double effort_full, double decay_s) {
    const double rho = std::min(std::abs(effort) / effort_full, 1.0);
    if (rho >= phi) {
      t = 0.0;
      peak = rho;
    } else {
      t += kPeriod_s;
    }
    phi = std::exp(-t / decay_s) * peak;
    return phi;
  }
};

TEST(AdaptiveDamping, RandomEfforts_EqualThePrintedAlgorithmUpToChatter) {
  auto rng = seededRandom(3);
  std::normal_distribution<double> noise;
  for (int trial = 0; trial < cases(40); ++trial) {
    const double decay_s = std::uniform_real_distribution<double>(0.05, 2.0)(rng);
    const double effort_full = std::uniform_real_distribution<double>(0.5, 10.0)(rng);
    PrintedAlgorithm printed;
    double phi = 0.0, effort = 0.0;
    for (int k = 0; k < 2000; ++k) {
      effort = 0.99 * effort + 0.3 * noise(rng) + (k % 500 == 250 ? 8.0 : 0.0);
      const double expected = printed.update(effort, effort_full, decay_s);
      phi = activate(phi, effort, 0.0, effort_full, decay_s, 1, kPeriod_s);
      // On a slow release the printed algorithm decays for a tick below ρ, then jumps back: at most
      // T/τ.
      EXPECT_LE(std::abs(phi - expected), kPeriod_s / decay_s * (1.0 + 1e-9));
      EXPECT_GE(phi, expected - 1e-12);
    }
  }
}

TEST(AdaptiveDamping, OneTimeConstantAfterPeak_IsExpOfMinusOne) {
  double phi = activate(0.0, 9.0, 0.5, 5.0, 0.3, 1, kPeriod_s);
  EXPECT_EQ(phi, 1.0);
  for (int k = 0; k < 300; ++k) phi = activate(phi, 0.0, 0.5, 5.0, 0.3, 1, kPeriod_s);
  EXPECT_NEAR(phi, std::exp(-1.0), tolerance(1e-12));  // closed form
}

TEST(AdaptiveDamping, ConstantEffort_HoldsItsActivation) {
  double phi = 0.0;
  for (int k = 0; k < 1000; ++k) phi = activate(phi, -2.75, 0.5, 5.0, 0.3, 1, kPeriod_s);
  EXPECT_DOUBLE_EQ(phi, 0.5);  // (2.75 − 0.5) / (5 − 0.5)
}

TEST(AdaptiveDamping, EffortInsideDeadBand_GivesNoDamping) {
  EXPECT_EQ(activate(0.0, 0.5, 0.5, 5.0, 0.3, 1, kPeriod_s), 0.0);
  EXPECT_GT(activate(0.0, 0.51, 0.5, 5.0, 0.3, 1, kPeriod_s), 0.0);
}

TEST(AdaptiveDamping, SkippedPeriods_DecayAsOneLongerStep) {
  EXPECT_TRUE(rc::check("k periods at once equal k single ones", [] {
    const int k = *rc::gen::inRange(1, 60);
    const double start = *rc::gen::inRange(1, 1001) * 1e-3;
    double single = start;
    for (int i = 0; i < k; ++i) single = activate(single, 0.0, 0.5, 5.0, 0.3, 1, kPeriod_s);
    const double at_once = activate(start, 0.0, 0.5, 5.0, 0.3, k, kPeriod_s);
    RC_ASSERT(std::abs(at_once - single) <= 1e-14);
  }));
}

TEST(AdaptiveDamping, NonFiniteEffort_CountsAsFullForce) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_EQ(activate(0.2, bad, 0.5, 5.0, 0.3, 1, kPeriod_s), 1.0);
  }
}

TEST(AdaptiveDamping, NonFiniteState_IsReplaced) {
  EXPECT_EQ(activate(std::nan(""), 0.0, 0.5, 5.0, 0.3, 1, kPeriod_s), 0.0);
  EXPECT_EQ(activate(HUGE_VAL, 0.0, 0.5, 5.0, 0.3, 1, kPeriod_s), 1.0);
}

TEST(AdaptiveDamping, FullNotAboveDeadBand_IsAStepAtTheDeadBand) {
  for (const double full : {0.5, 0.1, -1.0, std::nan("")}) {
    EXPECT_EQ(activate(0.0, 0.5, 0.5, full, 0.3, 1, kPeriod_s), 0.0);
    EXPECT_EQ(activate(0.0, 0.6, 0.5, full, 0.3, 1, kPeriod_s), 1.0);
  }
}

TEST(AdaptiveDamping, DecayTimeNotPositive_DecaysAtOnce) {
  for (const double decay_s : {0.0, -1.0, std::nan("")}) {
    EXPECT_EQ(activate(1.0, 0.0, 0.5, 5.0, decay_s, 1, kPeriod_s), 0.0);
  }
}

TEST(AdaptiveDamping, AnyInput_StaysBetweenZeroAndOne) {
  EXPECT_TRUE(
      rc::check("range", [](double phi, double effort, double dead, double full, double decay_s) {
        const double out = activate(phi, effort, dead, full, decay_s, 3, kPeriod_s);
        RC_ASSERT(out >= 0.0);
        RC_ASSERT(out <= 1.0);
      }));
}

TEST(AdaptiveDamping, UnitOfEffort_DoesNotChangeActivation) {
  EXPECT_TRUE(rc::check("scaling", [] {
    const double unit = std::exp2(*rc::gen::inRange(-12, 13));
    const double effort = *rc::gen::inRange(-8000, 8001) * 1e-3;
    RC_ASSERT(activate(0.25, unit * effort, unit * 0.5, unit * 5.0, 0.3, 1, kPeriod_s) ==
              activate(0.25, effort, 0.5, 5.0, 0.3, 1, kPeriod_s));
  }));
}

/// Four axes: two of the base (the second with palm contact) and two of the hand.
AdaptiveDampingConfig fourAxes() {
  AdaptiveDampingConfig c{4,           AxisEffort(4, 0.0), AxisEffort(4, 10.0), AxisTime(4, 0.3),
                          AxisFlag(4), AxisFlag(4)};
  c.palm_contact[1] = true;
  c.hand_axis[2] = c.hand_axis[3] = true;
  return c;
}

const auto fourEfforts = of<AxisEffort, double, double, double, double>;

TEST(AdaptiveDamping, Equation5_HandAxesUseTheirOwnAndBaseAxesTheLargest) {
  const auto s = adaptDamping({}, fourEfforts(9.0, 3.0, 2.0, -5.0), fourAxes(), 1, kPeriod_s);
  EXPECT_DOUBLE_EQ(s.phi[2], 0.2);
  EXPECT_DOUBLE_EQ(s.phi[3], 0.5);
  EXPECT_DOUBLE_EQ(s.phi[0], 0.5);  // not its own 0.9: Eq. (5) as printed
  EXPECT_DOUBLE_EQ(s.phi[1], 0.5);  // its own 0.3 is smaller
}

TEST(AdaptiveDamping, PalmContact_RaisesItsOwnAxis) {
  const auto s = adaptDamping({}, fourEfforts(0.0, 8.0, 2.0, 0.0), fourAxes(), 1, kPeriod_s);
  EXPECT_DOUBLE_EQ(s.phi[1], 0.8);
  EXPECT_DOUBLE_EQ(s.phi[0], 0.2);
}

TEST(AdaptiveDamping, DeviceWithoutHandAxes_DampsEachAxisByItsOwnEffort) {
  AdaptiveDampingConfig c = fourAxes();
  c.hand_axis = AxisFlag(4);
  c.palm_contact = AxisFlag(4);
  const auto s = adaptDamping({}, fourEfforts(9.0, 3.0, 2.0, -5.0), c, 1, kPeriod_s);
  EXPECT_DOUBLE_EQ(s.phi[0], 0.9);
  EXPECT_DOUBLE_EQ(s.phi[1], 0.3);
  EXPECT_DOUBLE_EQ(s.phi[2], 0.2);
  EXPECT_DOUBLE_EQ(s.phi[3], 0.5);
}

TEST(AdaptiveDamping, StateOfABaseAxis_KeepsItsOwnActivationNotTheLargest) {
  const AdaptiveDampingConfig c = fourAxes();
  auto s = adaptDamping({}, fourEfforts(0.0, 0.0, 10.0, 0.0), c, 1, kPeriod_s);
  s = adaptDamping(s, fourEfforts(0.0, 0.0, 0.0, 0.0), c, 300, kPeriod_s);
  EXPECT_NEAR(s.phi[2], std::exp(-1.0), tolerance(1e-12));
  EXPECT_NEAR(s.phi[0], std::exp(-1.0), tolerance(1e-12));
  EXPECT_EQ(s.own[0], 0.0);
  EXPECT_EQ(s.phi[3], 0.0);
}

TEST(AdaptiveDamping, FilesOfDeviceAndGains_AreMatchedAxisByAxis) {
  DeviceModel device;
  device.axes.resize(2);
  device.axes[1].group = AxisGroup::kHand;
  RenderingConfig rendering;
  rendering.axes.resize(2);
  rendering.axes[0].palm_contact = true;
  rendering.axes[1].effort_full = 0.4;
  rendering.axes[1].effort_dead = 0.04;
  rendering.axes[1].decay_s = 0.7;
  const AdaptiveDampingConfig c = makeAdaptiveDamping(device, rendering);
  EXPECT_EQ(c.axes, 2);
  EXPECT_FALSE(c.hand_axis[0]);
  EXPECT_TRUE(c.hand_axis[1]);
  EXPECT_TRUE(c.palm_contact[0]);
  EXPECT_FALSE(c.palm_contact[1]);
  EXPECT_EQ(c.effort_full[1], 0.4);
  EXPECT_EQ(c.effort_dead[1], 0.04);
  EXPECT_EQ(c.decay_s[1], 0.7);
}

TEST(AdaptiveDamping, InTheTick_DoesNotAllocate) {
  const AdaptiveDampingConfig c = fourAxes();
  const AllocationScope scope;
  const auto s = adaptDamping({}, fourEfforts(9.0, 3.0, 2.0, -5.0), c, 1, kPeriod_s);
  EXPECT_EQ(scope.allocations(), 0U);
  EXPECT_EQ(s.phi.size(), 4);
}

}  // namespace
}  // namespace wholehand::test
