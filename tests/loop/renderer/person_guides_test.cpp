// Checks walls and corridor of a prescription together by energy.
#include "loop/renderer/person_guides.hpp"

#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand::test {
namespace {

constexpr int kAxes = 4;  // x, y, z, and a rotation

AxisPosition drawn(std::mt19937_64& random, double most) {
  AxisPosition q(kAxes);
  for (int a = 0; a < kAxes; ++a) q[a] = uniform(random, -most, most);
  return q;
}

PersonGuidesConfig drawnGuides(std::mt19937_64& random) {
  PersonGuidesConfig config;
  LimitWallConfig& walls = config.walls;
  walls.axes = kAxes;
  walls.lower = walls.upper = walls.band = AxisPosition(kAxes);
  walls.stiffness = AxisStiffness(kAxes);
  walls.most = AxisEffort(kAxes);
  for (int a = 0; a < kAxes; ++a) {
    walls.lower[a] = uniform(random, -0.1, -0.03);
    walls.upper[a] = uniform(random, 0.03, 0.1);
    walls.band[a] = 0.01;
    walls.stiffness[a] = random() % 4 == 0 ? 0.0 : uniform(random, 50.0, 600.0);
    walls.most[a] = uniform(random, 1.0, 5.0);
  }
  config.corridor = {uniform(random, 0.005, 0.03), uniform(random, 50.0, 400.0), 3.0};
  config.translations = {0, 1, random() % 2 == 0 ? 2 : -1};
  return config;
}

MovementGoal drawnGoal(std::mt19937_64& random) {
  MovementGoal goal{random() % 4 != 0, random() % 3, {}};
  goal.at_m = {uniform(random, -0.12, 0.12), uniform(random, -0.12, 0.12),
               random() % 8 == 0 ? std::nan("") : uniform(random, -0.12, 0.12)};
  return goal;
}

double sumOf(const AxisEnergy& energy) {
  double sum = 0.0;
  for (const double part : energy) sum += part;
  return sum;
}

/// Stored energy if the hand were at q while walls, segment and scale stay as they are.
double storedAt(PersonGuides guides, const AxisPosition& q, const MovementGoal& goal,
                bool allowed) {
  guides.advance(q, goal, allowed, 0.0);
  return sumOf(guides.stored_j());
}

/// Prescriptions, poses at arming, rates, goals and silences of the client are drawn. Work on the
/// hand from tick to tick is the fall of the stored energy with everything else held; its effort is
/// that energy's slope.
TEST(PersonGuides, WorkGivenBack_IsAtMostWhatWasPutIn) {
  auto random = seededRandom(6604);
  double worst_j = -1.0, worst_slope = 0.0;
  const int draws = kReducedCounts ? 1000 : 100'000;
  for (int draw = 0; draw < draws; ++draw) {
    PersonGuides guides(drawnGuides(random));
    AxisPosition q = drawn(random, 0.15);
    const double tick_s = std::exp(uniform(random, std::log(1.25e-4), std::log(2e-2)));
    const double step = std::exp(uniform(random, std::log(1e-5), std::log(0.02)));
    const std::uint64_t steady = 1 + random() % 20;
    guides.begin(q);
    MovementGoal goal = drawnGoal(random);
    bool allowed = true;
    double given_j = 0.0;
    for (int tick = 0; tick < 30; ++tick) {
      if (random() % steady == 0) goal = drawnGoal(random);
      if (random() % 10 == 0) allowed = !allowed;
      guides.advance(q, goal, allowed, tick_s);
      AxisPosition to = q;
      for (int a = 0; a < kAxes; ++a) to[a] += uniform(random, -step, step);
      given_j += sumOf(guides.stored_j()) - storedAt(guides, to, goal, allowed);
      worst_j = std::max(worst_j, given_j);
      if (tick == 0 && draw % 50 == 0) {
        for (int a = 0; a < kAxes; ++a) {
          AxisPosition ahead = q, behind = q;
          ahead[a] += 1e-7;
          behind[a] -= 1e-7;
          const double slope =
              (storedAt(guides, ahead, goal, allowed) - storedAt(guides, behind, goal, allowed)) /
              2e-7;
          worst_slope = std::max(worst_slope, std::abs(guides.effort()[a] + slope));
        }
      }
      q = to;
    }
  }
  std::printf("figure: prescriptions give back %.2g J more than was put in (%d draws)\n", worst_j,
              draws);
  EXPECT_LE(worst_j, 1e-9);
  EXPECT_LE(worst_slope, 1e-3);  // 1e-7 m times the stiffness at a kink
}

TEST(PersonGuides, HandThatHasNotMovedSinceArming_FeelsNothing) {
  auto random = seededRandom(6605);
  const int draws = kReducedCounts ? 300 : 10'000;
  for (int draw = 0; draw < draws; ++draw) {
    PersonGuides guides(drawnGuides(random));
    const AxisPosition q = drawn(random, 0.2);
    guides.begin(q);
    for (int tick = 0; tick < 10; ++tick) {
      guides.advance(q, drawnGoal(random), random() % 3 != 0, 0.1);
      for (const double effort : guides.effort()) ASSERT_EQ(effort, 0.0);
    }
  }
}

/// Limits of ±50 mm on one axis, armed in the middle: bands of 10 mm, 300 N/m, at most 5 N.
PersonGuides oneAxis() {
  PersonGuidesConfig config;
  config.walls = {1,
                  AxisPosition(1, -0.05),
                  AxisPosition(1, 0.05),
                  AxisPosition(1, 0.01),
                  AxisStiffness(1, 300.0),
                  AxisEffort(1, 5.0)};
  PersonGuides guides(config);
  guides.begin(AxisPosition(1, 0.0));
  return guides;
}

TEST(PersonGuides, SilentClient_LetsTheEffortFallAndBeginAnew) {
  PersonGuides guides = oneAxis();
  const AxisPosition pressed(1, 0.05);
  guides.advance(pressed, {}, true, 1e-3);
  EXPECT_NEAR(guides.effort()[0], -3.0, 1e-12);
  double before = 3.0;
  for (int tick = 0; tick < 299; ++tick) {
    guides.advance(pressed, {}, tick > 50, 1e-3);  // heard again: it falls to the end all the same
    ASSERT_LT(-guides.effort()[0], before);
    before = -guides.effort()[0];
  }
  EXPECT_NEAR(before, 3.0 / 300.0, 1e-9);
  for (int tick = 0; tick < 10; ++tick) {
    guides.advance(pressed, {}, true, 1e-3);
    EXPECT_NEAR(guides.effort()[0], 0.0, 1e-9);
  }
  guides.advance(AxisPosition(1, 0.052), {}, true, 1e-3);  // from where the hand was
  EXPECT_NEAR(guides.effort()[0], -0.6, 1e-9);
}

TEST(PersonGuides, EffortOfAnExercise_DoesNotRiseWithinABand) {
  PersonGuides guides = oneAxis();
  const auto bounded = [&](double q, double effort) {
    ExerciseRecord exercise;
    exercise.effort = AxisEffort(1, effort);
    guides.boundExercise(AxisPosition(1, q), exercise);
    return exercise.effort[0];
  };
  EXPECT_EQ(bounded(0.039, -2.0), -2.0);
  EXPECT_EQ(bounded(0.041, -2.5), -2.0);
  EXPECT_EQ(bounded(0.060, -9.0), -2.0);
  EXPECT_EQ(bounded(0.041, -1.0), -1.0);
  EXPECT_EQ(bounded(0.039, -2.5), -2.5);
  guides.begin(AxisPosition(1, 0.045));  // armed within the band: none
  EXPECT_EQ(bounded(0.045, -2.0), 0.0);
}

}  // namespace
}  // namespace wholehand::test
