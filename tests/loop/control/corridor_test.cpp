// Compares the corridor with its closed form, and checks by energy that it only resists.
#include "loop/control/corridor.hpp"

#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kTick_s = 1e-3;
const CorridorConfig kCorridor{0.01, 200.0, 3.0};

MovementGoal goalAt(double x, double y, double z, std::uint64_t movement = 1) {
  return {true, movement, {x, y, z}};
}

CorridorState begun(const Vector3d& from_m, const MovementGoal& goal) {
  return advanceCorridor({}, kCorridor, from_m, goal, true, kTick_s);
}

TEST(Corridor, HandBesideTheWay_IsResistedFromTheRadiusOn) {
  const CorridorState state = begun(Vector3d::Zero(), goalAt(0.1, 0.0, 0.0));
  ASSERT_EQ(state.scale, 1.0);
  const auto force = [&](double x, double y, double z) {
    return pushOfCorridor(state, kCorridor, {x, y, z}).force_n;
  };
  EXPECT_EQ(force(0.05, 0.0, 0.0).norm(), 0.0);
  EXPECT_EQ(force(0.05, 0.0099, 0.0).norm(), 0.0);
  EXPECT_TRUE(force(0.05, 0.02, 0.0).isApprox(Vector3d(0.0, -2.0, 0.0), 1e-12));  // 200 · 10 mm
  EXPECT_TRUE(force(0.05, 0.0, 0.1).isApprox(Vector3d(0.0, 0.0, -3.0), 1e-12));   // the cap
  // Beyond the ends the nearest place of the segment counts: 3-4-5, 50 mm off, 40 mm outside.
  EXPECT_TRUE(force(0.13, 0.04, 0.0).isApprox(-3.0 * Vector3d(0.6, 0.8, 0.0), 1e-12));
  EXPECT_TRUE(force(-0.009, 0.012, 0.0).isApprox(-1.0 * Vector3d(-0.6, 0.8, 0.0), 1e-12));
  // Half the scale, 20 mm off: 1 N.
  CorridorState half = state;
  half.scale = 0.5;
  EXPECT_NEAR(pushOfCorridor(half, kCorridor, {0.05, 0.02, 0.0}).force_n.norm(), 1.0, 1e-12);
}

TEST(Corridor, AnotherGoal_WaitsUntilTheOldCorridorHasFallen) {
  CorridorState state = begun(Vector3d::Zero(), goalAt(0.1, 0.0, 0.0));
  const Vector3d hand(0.05, 0.02, 0.0);
  double before = 1.0;
  for (int tick = 1; tick < 300; ++tick) {
    state = advanceCorridor(state, kCorridor, hand, goalAt(0.0, 0.1, 0.0, 2), true, kTick_s);
    ASSERT_LT(state.scale, before);
    ASSERT_EQ(state.goal.movement, 1U);  // over the old segment
    before = state.scale;
    EXPECT_NEAR(state.scale, 1.0 - tick / 300.0, 1e-9);
  }
  for (int tick = 0; tick < 2; ++tick) {
    state = advanceCorridor(state, kCorridor, hand, goalAt(0.0, 0.1, 0.0, 3), true, kTick_s);
  }
  EXPECT_EQ(state.goal.movement, 3U);  // the last goal's, from where the hand is
  EXPECT_EQ(state.scale, 1.0);
  EXPECT_EQ(state.from_m, hand);
  EXPECT_EQ(pushOfCorridor(state, kCorridor, hand).force_n.norm(), 0.0);
}

TEST(Corridor, GoalThatIsNoPlace_HasNone) {
  const double nan = std::nan("");
  const double infinite = std::numeric_limits<double>::infinity();
  for (const MovementGoal& goal :
       {MovementGoal{}, goalAt(nan, 0.0, 0.0), goalAt(0.0, infinite, 0.0), goalAt(0.0, 0.0, 0.0),
        goalAt(0.005, 0.0, 0.0)}) {  // at the start, or within the radius
    EXPECT_EQ(begun(Vector3d::Zero(), goal).scale, 0.0);
  }
  EXPECT_EQ(
      advanceCorridor({}, kCorridor, Vector3d::Zero(), goalAt(0.1, 0.0, 0.0), false, kTick_s).scale,
      0.0);
  // A goal that becomes NaN ends the corridor.
  CorridorState state = begun(Vector3d::Zero(), goalAt(0.1, 0.0, 0.0));
  for (int tick = 0; tick < 301; ++tick) {
    state = advanceCorridor(state, kCorridor, Vector3d(0.05, 0.03, 0.0), goalAt(nan, 0.0, 0.0, 1),
                            true, kTick_s);
  }
  EXPECT_EQ(state.scale, 0.0);
}

/// The force is the slope of the stored energy, by central differences away from the kinks.
TEST(Corridor, Force_IsTheSlopeOfTheStoredEnergy) {
  auto random = seededRandom(6602);
  const auto place = [&random] {
    return Vector3d(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1),
                    uniform(random, -0.1, 0.1));
  };
  constexpr double kStep_m = 1e-6;
  for (int draw = 0; draw < 2000; ++draw) {
    const Vector3d goal = place(), hand = place();
    CorridorState state = begun(place(), goalAt(goal.x(), goal.y(), goal.z()));
    state.scale *= uniform(random, 0.1, 1.0);
    const CorridorPush push = pushOfCorridor(state, kCorridor, hand);
    for (int i = 0; i < 3; ++i) {
      const Vector3d d = kStep_m * Vector3d::Unit(i);
      const double slope = (pushOfCorridor(state, kCorridor, hand + d).stored_j -
                            pushOfCorridor(state, kCorridor, hand - d).stored_j) /
                           (2.0 * kStep_m);
      ASSERT_NEAR(push.force_n[i], -slope, 2e-3);  // K times a step at a kink: 2e-4
    }
  }
}

/// Goals flip, are NaN, change every tick; ticks of every length. With the walls of each tick held,
/// the work on the hand is the fall of the stored energy.
TEST(Corridor, WorkGivenBack_IsAtMostWhatWasPutIn) {
  auto random = seededRandom(6603);
  double worst_j = -1.0;
  const int draws = kReducedCounts ? 2000 : 100'000;
  for (int draw = 0; draw < draws; ++draw) {
    const double tick_s = std::exp(uniform(random, std::log(1.25e-4), std::log(5e-2)));
    const double step = std::exp(uniform(random, std::log(1e-5), std::log(0.05)));
    const std::uint64_t steady = 1 + random() % 30;
    CorridorState state;
    MovementGoal goal;
    Vector3d hand = Vector3d::Zero();
    double given_j = 0.0;
    for (int tick = 0; tick < 60; ++tick) {
      if (random() % steady == 0) {
        goal = goalAt(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1),
                      random() % 8 == 0 ? std::nan("") : uniform(random, -0.1, 0.1), random() % 3);
        goal.known = random() % 4 != 0;
      }
      state = advanceCorridor(state, kCorridor, hand, goal, random() % 10 != 0, tick_s);
      const Vector3d to =
          hand + Vector3d(uniform(random, -step, step), uniform(random, -step, step),
                          uniform(random, -step, step));
      given_j += pushOfCorridor(state, kCorridor, hand).stored_j -
                 pushOfCorridor(state, kCorridor, to).stored_j;
      hand = to;
      worst_j = std::max(worst_j, given_j);
    }
  }
  std::printf("figure: the corridor gives back %.2g J more than was put in (%d draws)\n", worst_j,
              draws);
  EXPECT_LE(worst_j, 1e-9);
}

}  // namespace
}  // namespace wholehand::test
