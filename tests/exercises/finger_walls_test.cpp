#include "loop/exercise/finger_cushions.hpp"
#include "support/constants.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// One finger axis with a lever arm of 8 cm.
FingerWallConfig oneFinger() {
  FingerWallConfig config;
  config.axes = 1;
  config.lever_arm_m = AxisLength(1, 0.08);
  config.stiffness = AxisStiffness(1, 1.5);
  config.effort_cap = AxisEffort(1, 0.72);
  config.follow_m_s = 0.04;
  return config;
}

constexpr double kLeadIn_m = 0.004;  // 0.05 rad of this axis

/// Runs one tick. A finger without contact has its avatar where the device is.
FingerWallState follow(const FingerWallState& state, double closure, double finger, double alpha,
                       bool touches = false) {
  const FingerWallInput seen{AxisPosition(1, closure), AxisPosition(1, finger),
                             AxisPosition(1, touches ? std::min(finger, closure) : finger),
                             touches ? 1U : 0U};
  return followClosure(state, seen, kLeadIn_m, alpha, oneFinger(), kPeriod_s);
}

/// Effort of the shell alone: the nozzle is closed.
double effortAt(const FingerWallState& state, double finger) {
  const FingerWallConfig walls = oneFinger();
  const Cushions shell{{{walls.stiffness[0], 0.1, 1.0, 1.0, 0.0}}, {0.0}, {1.0}, walls.effort_cap};
  return pressBottle({}, {.walls = state, .q_m = AxisPosition(1, finger), .elapsed_s = kPeriod_s},
                     shell)
      .effort[0];
}

TEST(FingerWalls, TargetFound_WallStandsTheLeadInBeforeTheTouch) {
  const FingerWallState state = follow({}, 2.0, 0.0, 0.0);
  EXPECT_TRUE(state.known[0]);
  // 4 mm of fingertip path at 8 cm are 0.05 rad.
  EXPECT_NEAR(state.position[0], 1.95, tolerance(1e-12));
}

TEST(FingerWalls, NoTouchOrTouchAtTheOpenEnd_HasNoWall) {
  for (const double closure : {kNan, -kInfinity, kInfinity}) {
    for (const double alpha : {0.0, 1.0}) {
      const FingerWallState state = follow({}, closure, 3.0, alpha);
      EXPECT_FALSE(state.known[0]);
      EXPECT_EQ(effortAt(state, 3.0), 0.0);
    }
  }
}

TEST(FingerWalls, TouchThatFluctuatesAtTheOpenEnd_KeepsTheEffortOfAPressedFinger) {
  // A thumb that grips with its axis nearly at the open end: the first touch is at 0.0002 rad, or
  // before the open end.
  FingerWallState state = follow({}, 0.0002, 0.05, 1.0, true);
  double before = 0.0;
  for (int i = 0; i < 400; ++i) {
    const bool overlaps = i % 60 > 30;
    const FingerWallInput seen{AxisPosition(1, overlaps ? -kInfinity : 0.0002),
                               AxisPosition(1, 0.05), AxisPosition(1, 0.0004), 1U};
    state = followClosure(state, seen, kLeadIn_m, 1.0, oneFinger(), kPeriod_s);
    const double effort = effortAt(state, 0.05);
    EXPECT_LE(effort, before + 1e-12) << i;  // it grows to the wall's effort and stays
    before = effort;
  }
  // Eq. (15): the lead-in of 0.05 rad and 0.0498 rad beyond the touch, at 1.5 N·m/rad.
  EXPECT_NEAR(before, -1.5 * (0.05 + 0.0498), tolerance(1e-12));
  // The target pushes the back of the finger open: the wall must not hold it.
  const FingerWallInput pushed{AxisPosition(1, -kInfinity), AxisPosition(1, 0.05),
                               AxisPosition(1, 0.06), 1U};
  EXPECT_GT(followClosure(state, pushed, kLeadIn_m, 1.0, oneFinger(), kPeriod_s).position[0],
            state.position[0]);
}

TEST(FingerWalls, FingerBeyondTheTouch_HasNoWallInAnyMotion) {
  FingerWallState state;
  for (int i = 0; i < 2000; ++i) {
    const double finger = 1.8 + 0.7 * std::sin(0.01 * i);
    state = follow(state, 1.0, finger, std::min(1.0, 1e-3 * i));
    ASSERT_EQ(effortAt(state, finger), 0.0) << i;
  }
}

TEST(FingerWalls, FingerInTheLeadInAtATransition_WallStartsAtTheFinger) {
  FingerWallState state = follow({}, 2.0, 1.98, 0.0);
  EXPECT_EQ(state.position[0], 1.98);
  for (int i = 0; i < 1000; ++i) state = follow(state, 2.0, 1.98, 1e-3 * i);
  EXPECT_EQ(state.position[0], 1.98) << "it came to a finger that touches nothing";
  // From the touch on it moves as usual: 0.04 m/s over 0.08 m, to the target at 1.95.
  for (int i = 0; i < 20; ++i) state = follow(state, 2.0, 2.01, 1.0, true);
  EXPECT_NEAR(state.position[0], 1.97, tolerance(1e-12));
  for (int i = 0; i < 100; ++i) state = follow(state, 2.0, 2.01, 1.0, true);
  EXPECT_NEAR(state.position[0], 1.95, tolerance(1e-12));
}

TEST(FingerWalls, TouchFoundLateWithTheFingerInTheLeadIn_WallStartsAtTheFinger) {
  const FingerWallState state = follow({}, 2.0, 1.98, 1.0);
  EXPECT_TRUE(state.known[0]);
  EXPECT_EQ(state.position[0], 1.98);
  EXPECT_EQ(effortAt(state, 1.98), 0.0);
}

TEST(FingerWalls, ClosingFinger_FeelsTheLeadInBeforeTheTouch) {
  FingerWallState state = follow({}, 2.0, 1.0, 0.0);
  for (int i = 1; i <= 1000; ++i) state = follow(state, 2.0, 1.0 + 1e-3 * i, 1.0);
  EXPECT_NEAR(effortAt(state, 2.0), -1.5 * 0.05, tolerance(1e-12));  // Eq. (15): k (θ − θ_wall)
}

TEST(FingerWalls, MovingTouch_IsFollowedAtTheWallsSpeed) {
  FingerWallState state = follow({}, 2.0, 0.0, 0.0);
  for (int i = 0; i < 100; ++i) state = follow(state, 1.5, 1.2, 0.5);
  // 0.1 s at 0.04 m/s over 0.08 m: 0.05 rad.
  EXPECT_NEAR(state.position[0], 1.90, tolerance(1e-12));
  EXPECT_NEAR(follow(state, 1.5, 1.2, 0.0).position[0], 1.45, tolerance(1e-12));
}

TEST(FingerWalls, TouchThatReachesAnUntouchedFinger_StopsAtTheFinger) {
  FingerWallState state = follow({}, 2.0, 1.2, 0.0);
  for (int i = 0; i < 3000; ++i) state = follow(state, 1.21, 1.2, 1.0);
  EXPECT_EQ(state.position[0], 1.2);
}

/// Effort of a grasp whose touch has disappeared, tick by tick, while the finger keeps closing.
TEST(FingerWalls, TouchThatDisappears_ReleasesInAnyMotion) {
  for (const double gone : {kNan, -kInfinity, 0.5}) {
    for (const double speed : {0.0, 10.0, -2.0}) {
      FingerWallState state = follow({}, 2.0, 1.0, 0.0);
      double finger = 2.15;  // 16 mm of path beyond the wall
      for (int i = 0; i < 100; ++i) state = follow(state, 2.0, finger, 1.0, true);
      double before = effortAt(state, finger);
      ASSERT_NEAR(before, -1.5 * 0.2, tolerance(1e-12));
      // At 0.15 m/s, 16 mm are released after 107 ms.
      for (int i = 0; i < 108; ++i) {
        finger += speed * kPeriod_s;
        state = follow(state, gone, finger, 1.0);
        const double effort = effortAt(state, finger);
        ASSERT_GE(effort, before) << "it grew";
        ASSERT_LE(effort - before, 1.5 * (0.15 / 0.08 + std::abs(speed)) * kPeriod_s + 1e-12);
        before = effort;
      }
      EXPECT_EQ(before, 0.0);
      EXPECT_FALSE(state.known[0]);
    }
  }
}

TEST(FingerWalls, TouchThatRecedesFromAnUntouchedFinger_YieldsFasterThanItCloses) {
  FingerWallState state = follow({}, 2.0, 1.0, 0.0);
  double finger = 1.99;
  state = follow(state, 2.0, finger, 1.0);
  for (int i = 0; i < 300; ++i) {
    const double before = effortAt(state, finger);
    finger += 3.0 * kPeriod_s;  // six times as fast as the wall follows
    state = follow(state, 4.0, finger, 1.0);
    ASSERT_GE(effortAt(state, finger), before);
  }
  EXPECT_EQ(effortAt(state, finger), 0.0);
}

TEST(FingerWalls, RandomClosures_EffortOfAStillFingerNeverJumps) {
  auto random = seededRandom(33);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  FingerWallState state;
  double before_n = 0.0, largest_n = 0.0;
  int pushed = 0;
  const int ticks = cases(100'000);
  for (int tick = 0; tick < ticks; ++tick) {
    const double closure = unit(random) < 0.01 ? kNan : 1.6 + 0.4 * unit(random);
    state = follow(state, closure, 1.8, 1.0, unit(random) < 0.9);
    const double effort_n = effortAt(state, 1.8) / 0.08;
    largest_n = std::max(largest_n, std::abs(effort_n - before_n));
    before_n = effort_n;
    pushed += effort_n < 0.0 ? 1 : 0;
  }
  EXPECT_GT(pushed, ticks / 100);
  // The wall's slope: k · 0.15 m/s divided by the lever arm twice, times T.
  EXPECT_LE(largest_n, 1.5 * 0.15 / (0.08 * 0.08) * 1e-3 + 1e-12);
}

TEST(FingerWalls, RandomUntouchedFingers_GetNoMoreThanTheirOwnClosingExplains) {
  auto random = seededRandom(34);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  FingerWallState state;
  double finger = 0.0, speed = 0.0, closure = 1.0, lowest = 0.0, alpha = 0.0;
  int pushed = 0;
  const int ticks = cases(1'000'000);
  for (int tick = 0; tick < ticks; ++tick) {
    if (tick % 3000 == 0) alpha = 0.0;
    if (tick % 50 == 0) speed = 10.0 * (2.0 * unit(random) - 1.0);
    if (unit(random) < 0.003) closure = unit(random) < 0.2 ? kNan : 3.0 * unit(random);
    closure += 0.002 * (2.0 * unit(random) - 1.0);
    finger = std::clamp(finger + speed * kPeriod_s, 0.0, 3.0);
    lowest = alpha > 0.0 ? std::min(lowest, finger) : finger;
    state = follow(state, closure, finger, alpha);
    alpha = std::min(1.0, alpha + 1e-3);
    const double effort = effortAt(state, finger);
    pushed += effort < 0.0 ? 1 : 0;
    ASSERT_GE(effort, -1.5 * (finger - lowest) - 1e-12) << tick;
    // The lead-in, and the 1 mm of path by which a touch may be missed.
    ASSERT_GE(effort, -1.5 * (0.05 + 1e-3 / 0.08) - 1e-12) << tick;
  }
  EXPECT_GT(pushed, ticks / 200);
}

/// A target with a soft side 10 mm deep; the finger is in it, and the wall starts at its surface.
FingerWallState squeezeSoft(const FingerWallState& state, double closure, double finger,
                            double alpha) {
  FingerWallConfig config = oneFinger();
  config.soft_m = 0.01;
  const FingerWallInput seen{AxisPosition(1, closure), AxisPosition(1, finger),
                             AxisPosition(1, finger), 0U, 1U};
  return followClosure(state, seen, 0.0, alpha, config, kPeriod_s);
}

TEST(FingerWalls, FingerInTheSoftSide_FeelsItsDepth) {
  FingerWallState state = squeezeSoft({}, 1.0, 1.0, 0.0);
  for (int i = 1; i <= 125; ++i) state = squeezeSoft(state, 1.0, 1.0 + 1e-3 * i, 1.0);
  EXPECT_NEAR(effortAt(state, 1.125), -1.5 * 0.125, tolerance(1e-12));  // k · 10 mm over 0.08 m
}

TEST(FingerWalls, SoftSideThatMovesOntoTheFinger_LeavesTheWallInPlace) {
  FingerWallState state = squeezeSoft({}, 1.0, 1.05, 0.0);
  EXPECT_EQ(effortAt(state, 1.05), 0.0);  // starts at the finger
  for (int i = 0; i < 1000; ++i) state = squeezeSoft(state, 1.0 - 1e-3 * i, 1.05, 1.0);
  EXPECT_EQ(effortAt(state, 1.05), 0.0) << "the arm's motion lifted the finger";
  for (int i = 1; i <= 50; ++i) state = squeezeSoft(state, 0.0, 1.05 + 1e-3 * i, 1.0);
  EXPECT_NEAR(effortAt(state, 1.1), -1.5 * 0.05, tolerance(1e-12));
}

TEST(FingerWalls, FingerBeforeTheTouchReportedAsInside_IsNotPushed) {
  FingerWallState state = squeezeSoft({}, 2.0, 1.9, 0.0);
  for (int i = 0; i < 1000; ++i) state = squeezeSoft(state, 1.5 + 1e-3 * i, 1.49, 1.0);
  EXPECT_EQ(effortAt(state, 1.49), 0.0);
}

TEST(FingerWalls, FingerThatPressesDeepAndReturns_GetsBackNoMoreEnergyThanItGave) {
  FingerWallState state = squeezeSoft({}, 1.0, 1.0, 0.0);
  for (int i = 1; i <= 1600; ++i) state = squeezeSoft(state, 1.0, 1.0 + 1e-3 * i, 1.0);
  EXPECT_EQ(state.position[0], 1.0);
  for (int i = 1600; i >= 0; --i) {
    state = squeezeSoft(state, 1.0, 1.0 + 1e-3 * i, 1.0);
    ASSERT_EQ(state.position[0], 1.0) << i;
  }
}

TEST(FingerWalls, SoftSideWithoutAFinger_WallStandsAtTheTouch) {
  FingerWallState state = squeezeSoft({}, 2.0, 1.0, 0.0);
  // The finger is before the touch, so it feels no effort.
  FingerWallConfig config = oneFinger();
  config.soft_m = 0.01;
  const FingerWallInput seen{AxisPosition(1, 1.5), AxisPosition(1, 1.2), AxisPosition(1, 1.2), 0U,
                             0U};
  state = followClosure(state, seen, 0.0, 0.5, config, kPeriod_s);
  EXPECT_EQ(state.position[0], 1.5);
  const FingerWallInput nearer{AxisPosition(1, 1.1), AxisPosition(1, 1.2), AxisPosition(1, 1.1), 0U,
                               0U};
  state = followClosure(state, nearer, 0.0, 0.5, config, kPeriod_s);
  EXPECT_EQ(state.position[0], 1.2) << "it came to a finger that touches nothing";
}

}  // namespace
}  // namespace wholehand::test
