#include "loop/control/transition.hpp"

#include "support/constants.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

TEST(Transition, EndsAndMiddle_AreThoseOfTheCubic) {
  EXPECT_EQ(transitionAlpha({0.0, true}), 0.0);
  EXPECT_EQ(transitionAlpha({0.5, true}), 0.5);
  EXPECT_EQ(transitionAlpha({1.0, true}), 1.0);
  EXPECT_NEAR(transitionAlpha({0.25, true}), 3.0 / 16.0 - 2.0 / 64.0, tolerance(1e-15));
  // Zero slope at both ends, steepest in the middle: slope 6u − 6u².
  EXPECT_NEAR(transitionAlpha({1e-4, true}) / 1e-4, 0.0, 1e-3);
  EXPECT_NEAR((transitionAlpha({0.501, true}) - transitionAlpha({0.499, true})) / 0.002, 1.5, 1e-5);
}

TEST(Transition, EngagedThenReleased_TakesTheConfiguredTimes) {
  const TransitionConfig config;
  TransitionState state;
  int on = 0, off = 0;
  while (state.u < 1.0) state = advanceTransition(state, 0.0, true, config, 1, kPeriod_s), ++on;
  while (state.u > 0.0) state = advanceTransition(state, 1.0, true, config, 1, kPeriod_s), ++off;
  EXPECT_NEAR(on, 1000, 1);  // T_on = 1 s
  EXPECT_NEAR(off, 300, 1);  // T_off = 0.3 s
}

TEST(Transition, DistanceBetweenTheThresholds_KeepsItsState) {
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
  EXPECT_FALSE(at(0.0, false));  // the control client is silent
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

TEST(Transition, SkippedPeriods_CountAsTicks) {
  const TransitionConfig config;
  TransitionState slow, fast;
  for (int i = 0; i < 100; ++i) slow = advanceTransition(slow, 0.0, true, config, 5, kPeriod_s);
  for (int i = 0; i < 500; ++i) fast = advanceTransition(fast, 0.0, true, config, 1, kPeriod_s);
  EXPECT_NEAR(slow.u, fast.u, tolerance(1e-12));
  EXPECT_NEAR(fast.u, 0.5, tolerance(1e-12));
}

TEST(Transition, FingerHeldStill_TipForceChangesByAtMostFiveHundredthsOfANewton) {
  // 10 N along the fingertip's path at 1 kHz. The steepest change is 10 N · 1.5 / 0.3 s · 1 ms =
  // 0.05 N.
  const TransitionConfig config;
  double largest_n = 0.0, before_n = 0.0;
  TransitionState state;
  for (int tick = 0; tick < 4000; ++tick) {
    const bool in = tick % 2000 < 1200;
    state = advanceTransition(state, in ? 0.0 : 1.0, true, config, 1, kPeriod_s);
    const double force_n = 10.0 * transitionAlpha(state);
    largest_n = std::max(largest_n, std::abs(force_n - before_n));
    before_n = force_n;
  }
  EXPECT_LE(largest_n, 0.05);
  EXPECT_GT(largest_n, 0.0499);  // the bound is nearly reached
}

}  // namespace
}  // namespace wholehand::test
