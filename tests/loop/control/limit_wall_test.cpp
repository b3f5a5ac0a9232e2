// Compares the walls at a person's limits with their closed forms, and checks by energy that they
// only resist.
#include "loop/control/limit_wall.hpp"

#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace wholehand::test {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// One axis of ± 100 mm.
LimitWallConfig oneAxis(double lower, double upper, double stiffness = 300.0, double most = 5.0) {
  LimitWallConfig config;
  config.axes = 1;
  config.lower = AxisPosition(1, lower);
  config.upper = AxisPosition(1, upper);
  config.band = AxisPosition(1, 0.01);
  config.stiffness = AxisStiffness(1, stiffness);
  config.most = AxisEffort(1, most);
  return config;
}

AxisPosition at(double q) {
  return AxisPosition(1, q);
}

TEST(LimitWall, HandThatComesFromInside_FeelsASpringOverTheLastBand) {
  const LimitWallConfig config = oneAxis(-0.05, 0.08);
  const LimitWallState walls = placeLimitWalls(config, at(0.0));
  // k p behind 70 mm, and behind -40 mm; at most 5 N, from 16.7 mm on. Stored: k p²/2, and beyond
  // the largest effort f̂ p − f̂²/2k.
  struct Case {
    double q, effort, stored_j;
  };
  for (const Case& c : std::initializer_list<Case>{{0.0, 0.0, 0.0},
                                                   {0.07, 0.0, 0.0},
                                                   {0.074, -1.2, 0.5 * 300.0 * 0.004 * 0.004},
                                                   {0.08, -3.0, 0.5 * 300.0 * 0.01 * 0.01},
                                                   {0.10, -5.0, 5.0 * 0.03 - 25.0 / 600.0},
                                                   {-0.044, 1.2, 0.5 * 300.0 * 0.004 * 0.004},
                                                   {-0.09, 5.0, 5.0 * 0.05 - 25.0 / 600.0}}) {
    const LimitPush push = pushOfLimit(walls, config, 0, c.q);
    EXPECT_NEAR(push.effort, c.effort, 1e-12) << c.q;
    EXPECT_NEAR(push.stored_j, c.stored_j, 1e-12) << c.q;
  }
}

TEST(LimitWall, AxisWithoutLimitOrStiffness_HasNone) {
  const LimitWallConfig open = oneAxis(-kInfinite, kInfinite);
  EXPECT_EQ(pushOfLimit(placeLimitWalls(open, at(0.0)), open, 0, 1e6).effort, 0.0);
  const LimitWallConfig soft = oneAxis(-0.05, 0.08, 0.0);
  EXPECT_EQ(pushOfLimit(placeLimitWalls(soft, at(0.0)), soft, 0, 0.2).effort, 0.0);
}

TEST(LimitWall, HandBeyondTheLimit_IsFollowedHomeHalfABandBehind) {
  const LimitWallConfig config = oneAxis(-0.05, 0.08);
  LimitWallState walls = placeLimitWalls(config, at(0.095));
  EXPECT_EQ(walls.upper[0], 0.095);
  walls = followHome(walls, config, at(0.092));  // not yet half a band home
  EXPECT_EQ(walls.upper[0], 0.095);
  walls = followHome(walls, config, at(0.085));
  EXPECT_NEAR(walls.upper[0], 0.090, 1e-15);
  walls = followHome(walls, config, at(0.094));  // outward: it stays, and resists
  EXPECT_NEAR(walls.upper[0], 0.090, 1e-15);
  EXPECT_NEAR(pushOfLimit(walls, config, 0, 0.094).effort, -300.0 * 0.004, 1e-12);
  walls = followHome(walls, config, at(0.0));
  EXPECT_NEAR(walls.upper[0], 0.07, 1e-15);  // home: the band of the limit
}

/// ∫ f dq of the walls as they stand, from a to b: exact, because f is linear between its kinks.
double workOf(const LimitWallState& walls, const LimitWallConfig& config, double a, double b) {
  const double way = config.most[0] / config.stiffness[0];
  std::array<double, 6> places{
      a, b, walls.upper[0], walls.upper[0] + way, walls.lower[0], walls.lower[0] - way};
  for (double& place : places) place = std::clamp(place, std::min(a, b), std::max(a, b));
  std::sort(places.begin(), places.end());
  double work_j = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double middle = 0.5 * (places[i - 1] + places[i]);
    work_j += pushOfLimit(walls, config, 0, middle).effort * (places[i] - places[i - 1]);
  }
  return a <= b ? work_j : -work_j;
}

/// Limits, poses at arming, paths and changes of limits are drawn. At every instant the walls have
/// given back at most what was put in; a hand that does not move feels nothing.
TEST(LimitWall, WorkGivenBack_IsAtMostWhatWasPutIn) {
  auto random = seededRandom(6601);
  double worst_j = -kInfinite;
  const int draws = kReducedCounts ? 2000 : 100'000;
  for (int draw = 0; draw < draws; ++draw) {
    LimitWallConfig config = oneAxis(uniform(random, -0.1, -0.02), uniform(random, 0.02, 0.1),
                                     uniform(random, 20.0, 2000.0), uniform(random, 0.5, 10.0));
    double q = uniform(random, -0.15, 0.15);
    LimitWallState walls = placeLimitWalls(config, at(q));
    ASSERT_EQ(pushOfLimit(walls, config, 0, q).effort, 0.0);
    const double step = std::exp(uniform(random, std::log(1e-5), std::log(0.05)));
    double given_j = 0.0;
    for (int tick = 0; tick < 60; ++tick) {
      if (random() % 20 == 0) {  // another limit, also narrower while the hand is there
        config.lower[0] = uniform(random, -0.1, -0.02);
        config.upper[0] = uniform(random, 0.02, 0.1);
        walls = placeLimitWalls(config, at(q));
        ASSERT_EQ(pushOfLimit(walls, config, 0, q).effort, 0.0);
      }
      const double to = q + uniform(random, -step, step);
      given_j += workOf(walls, config, q, to);
      q = to;
      const LimitWallState before = walls;
      walls = followHome(walls, config, at(q));
      ASSERT_LE(walls.upper[0], before.upper[0]);
      ASSERT_GE(walls.lower[0], before.lower[0]);
      worst_j = std::max(worst_j, given_j);
    }
  }
  std::printf("figure: limit walls give back %.2g J more than was put in (%d draws)\n", worst_j,
              draws);
  EXPECT_LE(worst_j, 1e-9);
}

}  // namespace
}  // namespace wholehand::test
