#include "exercise/finger_walls.hpp"

#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace wholehand::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPeriod_s = 1e-3;

/// One finger axis with a lever arm of 8 cm.
FingerWallConfig oneFinger() {
  FingerWallConfig config;
  config.axes = 1;
  config.lever_arm_m = AxisRatio(1, 0.08);
  config.stiffness = AxisRatio(1, 1.5);
  config.damping = AxisRatio(1, 0.006);
  config.effort_cap = AxisEffort(1, 0.72);
  config.follow_m_s = 0.04;
  return config;
}

FingerWallState follow(const FingerWallState& state, double closure, double finger, double alpha) {
  return followClosure(state, AxisPosition(1, closure), AxisPosition(1, finger), 0.004, alpha,
                       oneFinger(), kPeriod_s);
}

TEST(FingerWalls, TargetFound_StandTheLeadInBeforeTheTouch) {
  const FingerWallState state = follow({}, 2.0, 0.0, 0.0);
  EXPECT_EQ(state.known[0], 1.0);
  // 4 mm of fingertip path at 8 cm are 0.05 rad.
  EXPECT_NEAR(state.position[0], 1.95, tolerance(1e-12));
}

TEST(FingerWalls, NeverATouch_NoWall) {
  const FingerWallState state = follow({}, kNan, 3.0, 1.0);
  EXPECT_EQ(state.known[0], 0.0);
  EXPECT_EQ(fingerWallEffort(state, AxisPosition(1, 3.0), AxisVelocity(1), 1.0, {}, oneFinger())[0],
            0.0);
}

TEST(FingerWalls, TouchLostForSomeTicks_StayWhereTheyWere) {
  FingerWallState state = follow({}, 2.0, 0.0, 0.0);
  for (int i = 0; i < 50; ++i) state = follow(state, kNan, 1.0, 0.7);
  EXPECT_EQ(state.known[0], 1.0);
  EXPECT_NEAR(state.position[0], 1.95, tolerance(1e-12));
  EXPECT_EQ(follow(state, kNan, 1.0, 0.0).known[0], 0.0);  // faded out: gone
}

TEST(FingerWalls, TouchMovesWhileFelt_FollowAtTheirSpeed) {
  FingerWallState state = follow({}, 2.0, 0.0, 0.0);
  for (int i = 0; i < 100; ++i) state = follow(state, 1.0, 1.2, 0.5);
  // 0.1 s at 0.04 m/s over 0.08 m: 0.05 rad.
  EXPECT_NEAR(state.position[0], 1.90, tolerance(1e-12));
  EXPECT_NEAR(follow(state, 1.0, 1.2, 0.0).position[0], 0.95, tolerance(1e-12));
}

TEST(FingerWalls, TouchFoundLateWithTheFingerPastIt_BeginAtTheFinger) {
  const FingerWallState state = follow({}, 2.0, 2.4, 1.0);
  EXPECT_EQ(state.known[0], 1.0);
  EXPECT_EQ(state.position[0], 2.4);
  EXPECT_EQ(fingerWallEffort(state, AxisPosition(1, 2.4), AxisVelocity(1), 1.0, {}, oneFinger())[0],
            0.0);
}

TEST(FingerWalls, RandomClosures_EffortOfAStillFingerNeverJumps) {
  const FingerWallConfig config = oneFinger();
  auto random = seededRandom(33);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  FingerWallState state;
  double before_n = 0.0, largest_n = 0.0;
  bool any = false;
  for (int tick = 0; tick < 100'000; ++tick) {
    const double closure = unit(random) < 0.3 ? kNan : 1.0 + unit(random);
    state = follow(state, closure, 1.8, 1.0);
    const double effort =
        fingerWallEffort(state, AxisPosition(1, 1.8), AxisVelocity(1), 1.0, {}, config)[0];
    largest_n = std::max(largest_n, std::abs(effort / 0.08 - before_n));
    before_n = effort / 0.08;
    any = any || effort < 0.0;
  }
  EXPECT_TRUE(any);
  // The wall's slope: k · follow / lever · T = 1.5 · 0.5 · 1e-3 N·m, over 0.08 m: 0.0094 N.
  EXPECT_LE(largest_n, 1.5 * 0.5 * 1e-3 / 0.08 + 1e-12);
}

}  // namespace
}  // namespace wholehand::test
