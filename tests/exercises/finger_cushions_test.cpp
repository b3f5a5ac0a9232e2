#include "loop/exercise/finger_cushions.hpp"

#include "exercises/bar_table.hpp"
#include "support/seed.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

constexpr Bottle kBottle{4e-4, 25.0, 0.25, 0.3, {0.2, 0.02, 2e-3}};

/// Two fingers with lever arms of 8 and 5 cm, 280 N/m at the tip.
FingerWallConfig twoFingers() {
  FingerWallConfig walls;
  walls.axes = 2;
  walls.lever_arm_m = AxisLength(2, 0.08);
  walls.lever_arm_m[1] = 0.05;
  walls.stiffness = AxisStiffness(2);
  for (int i = 0; i < 2; ++i) {
    walls.stiffness[i] = 280.0 * walls.lever_arm_m[i] * walls.lever_arm_m[i];
  }
  walls.effort_cap = AxisEffort(2, 1.0);
  return walls;
}

/// For any motion of the fingers and any open state of the nozzle: the outflow is A Σ l Δy, to
/// 10^-12 l.
TEST(FingerCushions, OutflowOfTheNozzle_IsTheDisplacementOfTheDigits) {
  auto random = seededRandom(3911);
  const FingerWallConfig config = twoFingers();
  const Cushions cushions = cushionsOf(kBottle, config);
  FingerWallState walls{AxisPosition(2), AxisFlag(2, true), AxisPosition(2)};
  AxisPosition travel, q(2);
  double left_m3 = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    for (int a = 0; a < 2; ++a) {
      q[a] = std::max(-0.01, q[a] + uniform(random, -2e-3, 2.05e-3));
      walls.known[a] = random() % 500 != 0;
    }
    BottleInput seen{.walls = walls, .q_m = q};
    seen.open = static_cast<std::uint32_t>(random() % 4);
    seen.empty = random() % 4 == 0;
    seen.slit = uniform(random, 1e-6, 1.0);
    seen.ratios.viscosity = uniform(random, kThinnestRatio, kThickestRatio);
    seen.elapsed_s = kPeriod_s;
    const BottlePress press = pressBottle(travel, seen, cushions);
    double out_m3 = 0.0;
    for (int a = 0; a < 2; ++a) {
      const double before = travel.size() > 0 ? travel[a] : 0.0;
      out_m3 += 4e-4 * config.lever_arm_m[a] * std::max(0.0, press.travel[a] - before);
      EXPECT_LE(press.effort[a], 0.0);
    }
    travel = press.travel;
    left_m3 += press.out_m3;
    EXPECT_NEAR(press.out_m3, out_m3, 1e-15);
    EXPECT_NEAR(press.pressed_m3, 4e-4 * (0.08 * travel[0] + 0.05 * travel[1]), 1e-15);
  }
  EXPECT_GT(left_m3, 1e-5);
}

/// The nozzle opens, the bottle empties or the liquid becomes thin under a resting finger: the
/// effort changes by at most 0.05 N per tick at the tip.
TEST(FingerCushions, EffortOfARestingFinger_FallsSlowly) {
  auto random = seededRandom(3912);
  const FingerWallConfig config = twoFingers();
  const Cushions cushions = cushionsOf(kBottle, config);
  const FingerWallState walls{AxisPosition(2), AxisFlag(2, true), AxisPosition(2)};
  for (int play = 0; play < cases(1000); ++play) {
    AxisPosition travel(2), q(2);
    for (int a = 0; a < 2; ++a) q[a] = uniform(random, 0.0, 0.04) / config.lever_arm_m[a];
    AxisEffort before(2);
    BottleInput seen{.walls = walls, .q_m = q, .elapsed_s = kPeriod_s};
    seen.ratios.stiffness = kLargestWallRatio;
    for (int i = 0; i < 60; ++i) {
      if (i > 0 && random() % 10 == 0) {
        seen.open = static_cast<std::uint32_t>(random() % 4);
        seen.empty = random() % 2 == 0;
        seen.slit = uniform(random, 1e-6, 1.0);
        seen.ratios.viscosity = random() % 2 == 0 ? kThinnestRatio : kThickestRatio;
      }
      const BottlePress press = pressBottle(travel, seen, cushions);
      for (int a = 0; a < 2 && i > 0; ++a) {
        EXPECT_LT((press.effort[a] - before[a]) / config.lever_arm_m[a], 0.05);
      }
      before = press.effort;
      travel = press.travel;
    }
  }
}

/// Every digit feels the same bottle at its tip: after t at x the shell holds k k_s x/(k + k_s) +
/// (k x - ...) e^{-(k + k_s) t/d}, apart from p0.
TEST(FingerCushions, DigitsOfDifferentLeverArms_FeelTheSameBottle) {
  const FingerWallConfig config = twoFingers();
  const Cushions cushions = cushionsOf(kBottle, config);
  const FingerWallState walls{AxisPosition(2), AxisFlag(2, true), AxisPosition(2)};
  AxisPosition q(2), travel;
  q[0] = 0.01 / 0.08;
  q[1] = 0.01 / 0.05;
  BottlePress press;
  for (int i = 0; i < 500; ++i) {
    press = pressBottle(travel, {.walls = walls, .q_m = q, .open = 3U, .elapsed_s = kPeriod_s},
                        cushions);
    travel = press.travel;
  }
  const double d = 8.0 * 0.2 * 0.02 * 16e-8 / (kPi * 16e-12);        // 101.9 N·s/m
  const double rest = (280.0 * 0.25 + 280.0 * 25.0 * 0.01) / 305.0;  // q = p0
  const double exact = rest + (2.8 - rest) * std::exp(-305.0 * 0.5 / d);
  EXPECT_NEAR(-press.effort[0] / 0.08, exact, 2e-3);
  EXPECT_NEAR(-press.effort[1] / 0.05, exact, 2e-3);
}

TEST(FingerCushions, AxisWithoutAWall_ReleasesItsCushion) {
  const FingerWallConfig config = twoFingers();
  const FingerWallState none{AxisPosition(2), AxisFlag(2), AxisPosition(2)};
  AxisPosition travel(2, 0.1), q(2, 0.3);
  for (int i = 0; i < 300; ++i) {
    const BottlePress press =
        pressBottle(travel, {.walls = none, .q_m = q, .open = 3U, .elapsed_s = kPeriod_s},
                    cushionsOf(kBottle, config));
    EXPECT_EQ(press.effort[0], 0.0);
    travel = press.travel;
  }
  EXPECT_NEAR(travel[0], 0.1 * std::exp(-1.0), 2e-4);  // air_s
}

}  // namespace
}  // namespace wholehand::test
