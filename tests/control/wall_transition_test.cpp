#include "control/virtual_wall.hpp"
#include "support/constants.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// f_e of a wall of 5 N·m/rad and 0.1 N·m·s/rad at 1 rad that closes upwards.
double wallAtOne(double position, double velocity, double alpha = 1.0, double cap = 100.0) {
  return wallEffort({1.0, 1.0, 5.0, 0.1, cap}, position, velocity, alpha);
}

TEST(VirtualWall, MillionRandomStates_NeverPullAFingerIn) {
  auto random = seededRandom(31);
  std::uniform_real_distribution<double> unit(0.0, 1.0), both(-1.0, 1.0);
  double most = -kInfinite;
  for (int i = 0; i < cases(1'000'000); ++i) {
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const VirtualWall wall{both(random), side, 20.0 * unit(random), unit(random), unit(random)};
    // Mostly near the wall, where signs matter; p up to 2 rad, ṗ up to 20 rad/s.
    const double depth = both(random) * std::pow(10.0, -6.0 * unit(random)) * 2.0;
    const double effort =
        wallEffort(wall, wall.position + side * depth, 20.0 * both(random), unit(random));
    most = std::max(most, effort * side);
  }
  EXPECT_LE(most, 0.0);  // f_e · closing direction: Eq. (15) as corrected
}

TEST(VirtualWall, InsideIt_IsStiffnessTimesDepthPlusDamping) {
  // Eq. (15) by hand: −(5 · 0.2 + 0.1 · 0.5) = −1.05, halved by α.
  EXPECT_NEAR(wallAtOne(1.2, 0.5), -1.05, tolerance(1e-12));
  EXPECT_NEAR(wallAtOne(1.2, 0.5, 0.5), -0.525, tolerance(1e-12));
  EXPECT_EQ(wallAtOne(1.2, -11.0), 0.0);           // 1 − 1.1 < 0: it would pull
  EXPECT_EQ(wallAtOne(0.9, 5.0), 0.0);             // outside
  EXPECT_EQ(wallAtOne(1.2, 0.0, 1.0, 0.3), -0.3);  // capped
  EXPECT_NEAR(wallEffort({1.0, -1.0, 5.0, 0.1, 9.0}, 0.8, -0.5, 1.0), 1.05,
              tolerance(1e-12));  // the mirror image
}

TEST(VirtualWall, NotANumber_PushesNobody) {
  EXPECT_EQ(wallAtOne(kNan, 0.0), 0.0);
  EXPECT_EQ(wallAtOne(1.2, kNan), 0.0);
  EXPECT_EQ(wallAtOne(1.2, 0.0, kNan), 0.0);
  EXPECT_EQ(wallAtOne(kInfinite, 0.0), 0.0);
  EXPECT_EQ(wallEffort({kNan, 1.0, 5.0, 0.1, 9.0}, 1.2, 0.0, 1.0), 0.0);
  EXPECT_EQ(wallEffort({1.0, 1.0, 5.0, 0.1, kNan}, 1.2, 0.0, 1.0), 0.0);
}

TEST(Transition, AtItsEndsAndInTheMiddle_IsTheCubic) {
  EXPECT_EQ(transitionAlpha({0.0, true}), 0.0);
  EXPECT_EQ(transitionAlpha({0.5, true}), 0.5);
  EXPECT_EQ(transitionAlpha({1.0, true}), 1.0);
  EXPECT_NEAR(transitionAlpha({0.25, true}), 3.0 / 16.0 - 2.0 / 64.0, tolerance(1e-15));
  // Level at both ends, steepest in the middle: slope 6u − 6u².
  EXPECT_NEAR(transitionAlpha({1e-4, true}) / 1e-4, 0.0, 1e-3);
  EXPECT_NEAR((transitionAlpha({0.501, true}) - transitionAlpha({0.499, true})) / 0.002, 1.5, 1e-5);
}

TEST(Transition, EngagedThenReleased_TakesItsTimes) {
  const TransitionConfig config;
  TransitionState state;
  int on = 0, off = 0;
  while (state.u < 1.0) state = advanceTransition(state, 0.0, true, config, 1, kPeriod_s), ++on;
  while (state.u > 0.0) state = advanceTransition(state, 1.0, true, config, 1, kPeriod_s), ++off;
  EXPECT_NEAR(on, 1000, 1);  // T_on = 1 s
  EXPECT_NEAR(off, 300, 1);  // T_off = 0.3 s
}

TEST(Transition, DistanceBetweenTheTwo_KeepsWhatItWas) {
  const TransitionConfig config;  // 20 and 30 mm
  TransitionState state;
  const auto at = [&](double distance_m, bool allowed = true) {
    state = advanceTransition(state, distance_m, allowed, config, 1, kPeriod_s);
    return state.engaged;
  };
  EXPECT_FALSE(at(0.025));
  EXPECT_TRUE(at(0.0199));
  EXPECT_TRUE(at(0.0299));
  EXPECT_FALSE(at(0.0301));
  EXPECT_FALSE(at(0.0201));
  EXPECT_TRUE(at(-0.01));  // the palm presses in
  EXPECT_FALSE(at(kNan));
  EXPECT_TRUE(at(0.0));
  EXPECT_FALSE(at(kInfinite));
  EXPECT_TRUE(at(0.0));
  EXPECT_FALSE(at(0.0, false));  // the controls' holder is silent
}

TEST(Transition, ReversedAtAnyMoment_NeverJumps) {
  const TransitionConfig config;
  auto random = seededRandom(32);
  TransitionState state;
  double before = 0.0, largest = 0.0;
  for (int tick = 0; tick < cases(200'000); ++tick) {
    const double distance_m = random() % 97 == 0 ? 1.0 : random() % 41 == 0 ? 0.0 : 0.025;
    state = advanceTransition(state, distance_m, true, config, 1, kPeriod_s);
    const double alpha = transitionAlpha(state);
    largest = std::max(largest, std::abs(alpha - before));
    before = alpha;
  }
  EXPECT_LE(largest, 1.5 * kPeriod_s / config.release_s);  // peak slope of the cubic
  EXPECT_GT(largest, 0.0);
}

TEST(Transition, SkippedPeriods_CountInFull) {
  const TransitionConfig config;
  TransitionState slow, fast;
  for (int i = 0; i < 100; ++i) slow = advanceTransition(slow, 0.0, true, config, 5, kPeriod_s);
  for (int i = 0; i < 500; ++i) fast = advanceTransition(fast, 0.0, true, config, 1, kPeriod_s);
  EXPECT_NEAR(slow.u, fast.u, tolerance(1e-12));
  EXPECT_NEAR(fast.u, 0.5, tolerance(1e-12));
}

TEST(Transition, FingerHeldStill_TipForceChangesByAtMostFiveHundredthsOfANewton) {
  // The figure: |f_e| ≤ 10 N, 1 kHz. The steepest: 10 N · 1.5 / 0.3 s · 1 ms = 0.05 N.
  const TransitionConfig config;
  const VirtualWall wall{0.0, 1.0, 1000.0, 0.0, 10.0};  // along the fingertip's path: N/m, N
  double largest_n = 0.0, before_n = 0.0;
  TransitionState state;
  for (int tick = 0; tick < 4000; ++tick) {
    const bool in = tick % 2000 < 1200;
    state = advanceTransition(state, in ? 0.0 : 1.0, true, config, 1, kPeriod_s);
    const double force_n = wallEffort(wall, 0.01, 0.0, transitionAlpha(state));
    largest_n = std::max(largest_n, std::abs(force_n - before_n));
    before_n = force_n;
  }
  EXPECT_LE(largest_n, 0.05);
  EXPECT_GT(largest_n, 0.0499);  // it does come close
}

}  // namespace
}  // namespace wholehand::test
