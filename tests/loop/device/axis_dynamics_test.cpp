#include "loop/device/simulated/axis_dynamics.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

/// m q̈ + b q̇ + k q = 0 from (q0, v0), underdamped: the closed form of a decaying oscillation.
double freeDecay(double m, double b, double k, double q0, double v0, double t_s) {
  const double sigma = b / (2.0 * m);
  const double omega = std::sqrt(k / m - sigma * sigma);
  return std::exp(-sigma * t_s) *
         (q0 * std::cos(omega * t_s) + (v0 + sigma * q0) / omega * std::sin(omega * t_s));
}

class AxisDynamicsAtRate : public ::testing::TestWithParam<double> {
 protected:
  double period_s() const { return 1.0 / GetParam(); }
  int ticks(double time_s) const { return static_cast<int>(std::lround(time_s * GetParam())); }
};
INSTANTIATE_TEST_SUITE_P(Rates, AxisDynamicsAtRate, ::testing::Values(1000.0, 4000.0));

TEST_P(AxisDynamicsAtRate, FreeDecay_FollowsClosedForm) {
  AxisDynamics axis({.mass = 1.8, .damping = 6.0, .stiffness = 900.0, .lower = -1, .upper = 1},
                    period_s());
  axis.place(0.05, -0.4);
  for (int i = 1; i <= ticks(1.0); ++i) {
    axis.advance({});
    ASSERT_NEAR(axis.position(), freeDecay(1.8, 6.0, 900.0, 0.05, -0.4, i * period_s()), 1e-9);
  }
}

TEST_P(AxisDynamicsAtRate, StepEffort_FollowsClosedForm) {
  // Around the new rest position F/k the motion is the free decay from -F/k.
  constexpr double kForce = 3.0, kStiffness = 135.0;
  AxisDynamics axis(
      {.mass = 1.35, .damping = 7.45, .stiffness = kStiffness, .lower = -1, .upper = 1},
      period_s());
  for (int i = 1; i <= ticks(1.0); ++i) {
    axis.advance({kForce, kForce});
    const double rest = kForce / kStiffness;
    ASSERT_NEAR(axis.position(),
                rest + freeDecay(1.35, 7.45, kStiffness, -rest, 0.0, i * period_s()), 1e-9);
  }
}

TEST_P(AxisDynamicsAtRate, RampEffortOnDamper_FollowsClosedForm) {
  // m v̇ + b v = r t: v = (r/b)(t - τ(1 - e^(-t/τ))), τ = m/b.
  constexpr double kRate = 20.0, kMass = 0.8, kDamping = 6.0, kTau = kMass / kDamping;
  AxisDynamics axis({.mass = kMass, .damping = kDamping, .lower = -10, .upper = 10}, period_s());
  for (int i = 0; i < ticks(0.5); ++i) {
    axis.advance({kRate * i * period_s(), kRate * (i + 1) * period_s()});
    const double t_s = (i + 1) * period_s();
    ASSERT_NEAR(axis.velocity(), kRate / kDamping * (t_s + kTau * std::expm1(-t_s / kTau)), 1e-9);
  }
}

TEST_P(AxisDynamicsAtRate, LightStiffFinger_FollowsClosedForm) {
  // A finger axis settles many times faster than the arm.
  AxisDynamics axis({.mass = 2e-4, .damping = 0.03, .stiffness = 40.0, .lower = -1, .upper = 1},
                    period_s());
  axis.place(0.3, 0.0);
  for (int i = 1; i <= ticks(0.05); ++i) {
    axis.advance({});
    ASSERT_NEAR(axis.position(), freeDecay(2e-4, 0.03, 40.0, 0.3, 0.0, i * period_s()), 1e-9);
  }
}

TEST_P(AxisDynamicsAtRate, DryFrictionOnly_StopsAfterKineticEnergyOverFriction) {
  AxisDynamics axis({.mass = 0.8, .coulomb = 0.2, .lower = -1, .upper = 1}, period_s());
  axis.place(0.0, 0.3137);
  for (int i = 0; i < ticks(3.0); ++i) axis.advance({});
  EXPECT_EQ(axis.velocity(), 0.0);
  // ½ m v² = f_c d
  EXPECT_NEAR(axis.position(), 0.5 * 0.8 * 0.3137 * 0.3137 / 0.2, 1e-9);
}

TEST_P(AxisDynamicsAtRate, EffortBelowDryFriction_DoesNotMoveAtAll) {
  AxisDynamics axis({.mass = 0.8, .damping = 6, .coulomb = 0.2, .lower = -1, .upper = 1},
                    period_s());
  for (int i = 0; i < ticks(1.0); ++i) {
    axis.advance({0.2, 0.2});
    axis.advance({0.2, -0.2});
    axis.advance({-0.2, 0.1999});
  }
  EXPECT_EQ(axis.position(), 0.0);
  EXPECT_EQ(axis.velocity(), 0.0);
}

TEST_P(AxisDynamicsAtRate, RampThroughDryFriction_BreaksAwayInsideThePeriod) {
  // The effort passes f_c = 0.2 at 40 % of the period; m v = ½ r (T - t*)².
  AxisDynamics axis({.mass = 0.5, .coulomb = 0.2, .lower = -1, .upper = 1}, period_s());
  axis.advance({0.0, 0.5});
  const double moving_s = 0.6 * period_s(), rate = 0.5 / period_s();
  EXPECT_NEAR(axis.velocity() / (0.5 * rate * moving_s * moving_s / 0.5), 1.0, 1e-5);
}

TEST_P(AxisDynamicsAtRate, DryFrictionAndSpring_LosesFourFcOverKPerCycle) {
  // Each half cycle of a spring with Coulomb friction loses 2 f_c/k of amplitude (the textbook's
  // staircase), until the mass sticks where k |q| <= f_c.
  constexpr double kStiffness = 400.0, kFriction = 0.8, kMass = 1.0, kStart = 0.0191;
  AxisDynamics axis(
      {.mass = kMass, .stiffness = kStiffness, .coulomb = kFriction, .lower = -1, .upper = 1},
      period_s());
  axis.place(kStart, 0.0);
  const double half_cycle_s = M_PI / std::sqrt(kStiffness / kMass);
  double lowest = kStart;
  for (int i = 0; i < ticks(1.05 * half_cycle_s); ++i) {
    axis.advance({});
    lowest = std::min(lowest, axis.position());
  }
  EXPECT_NEAR(lowest, -(kStart - 2.0 * kFriction / kStiffness), 2e-6);
  for (int i = 0; i < ticks(2.0); ++i) axis.advance({});
  // 0.0191, -0.0151, 0.0111, -0.0071, 0.0031, and 0.0031 - 0.004 past the middle: k q = 0.36 < f_c.
  EXPECT_NEAR(axis.position(), 0.0009, 1e-9);
  EXPECT_EQ(axis.velocity(), 0.0);
}

TEST_P(AxisDynamicsAtRate, HittingAStop_RestsThereAndLeavesWhenPulled) {
  AxisDynamics axis({.mass = 0.8, .coulomb = 0.2, .lower = -0.12, .upper = 0.12}, period_s());
  axis.place(0.11, 1.5);
  for (int i = 0; i < ticks(0.2); ++i) {
    axis.advance({5.0, 5.0});
    ASSERT_LE(axis.position(), 0.12);
  }
  EXPECT_EQ(axis.position(), 0.12);
  EXPECT_EQ(axis.velocity(), 0.0);
  axis.advance({-0.2, -0.2});
  EXPECT_EQ(axis.position(), 0.12);  // dry friction still holds it
  axis.advance({-1.0, -1.0});
  // ½ a T² at a = (1 - 0.2)/0.8
  EXPECT_NEAR((0.12 - axis.position()) / (0.5 * period_s() * period_s()), 1.0, 1e-6);
}

TEST(AxisDynamics, TwoRates_AgreeThroughStickSlipAndStops) {
  // The effect of a force that is constant over a millisecond must not depend on the sampling rate:
  // 1 kHz and 4 kHz agree at every millisecond, with dry friction and stops.
  const AxisPlant plant{.mass = 0.8,
                        .damping = 6.0,
                        .stiffness = 150.0,
                        .coulomb = 0.4,
                        .lower = -0.02,
                        .upper = 0.02};
  AxisDynamics slow(plant, 1e-3), fast(plant, 0.25e-3);
  for (int i = 0; i < 3000; ++i) {
    const double begin = 4.0 * std::sin(0.013 * i), end = 4.0 * std::sin(0.013 * (i + 1));
    slow.advance({begin, end});
    for (int j = 0; j < 4; ++j) {
      fast.advance({begin + (end - begin) * j / 4.0, begin + (end - begin) * (j + 1) / 4.0});
    }
    ASSERT_NEAR(slow.position(), fast.position(), 1e-9) << "at " << i << " ms";
    ASSERT_NEAR(slow.velocity(), fast.velocity(), 1e-6) << "at " << i << " ms";
  }
}

TEST(AxisDynamics, AnyPassivePlantAndEffort_NeverGainsMoreThanTheWorkDone) {
  EXPECT_TRUE(rc::check("kinetic and spring energy grow by at most effort times way", [] {
    const auto real = [](double low, double high) {
      return low + (high - low) * *rc::gen::inRange(0, 100001) / 100000.0;
    };
    const AxisPlant plant{.mass = std::pow(10.0, real(-4, 0.3)),
                          .damping = real(0, 1) < 0.3 ? 0.0 : std::pow(10.0, real(-3, 1)),
                          .stiffness = real(0, 1) < 0.3 ? 0.0 : std::pow(10.0, real(-1, 3)),
                          .coulomb = real(0, 1) < 0.3 ? 0.0 : real(0, 1),
                          .lower = -real(0.01, 0.1),
                          .upper = real(0.01, 0.1)};
    AxisDynamics axis(plant, real(0, 1) < 0.5 ? 1e-3 : 0.25e-3);
    const auto energy = [&] {
      return 0.5 * plant.mass * axis.velocity() * axis.velocity() +
             0.5 * plant.stiffness * axis.position() * axis.position();
    };
    for (int i = 0; i < 50; ++i) {
      const double effort = real(-3, 3);
      const double q_before = axis.position(), before = energy();
      axis.advance({effort, effort});
      const double work = effort * (axis.position() - q_before);
      // One grain (2^-20 of the period) of the force may be missed at an event.
      RC_ASSERT(energy() - before <= work + 1e-9 * (before + std::abs(work)) + 1e-12);
      RC_ASSERT(axis.position() >= plant.lower && axis.position() <= plant.upper);
    }
  }));
}

}  // namespace
}  // namespace wholehand
