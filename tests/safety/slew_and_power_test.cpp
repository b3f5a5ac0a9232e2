#include "safety/power_limiter.hpp"
#include "safety/slew_limiter.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

template <class Array>
Array two(double a, double b) {
  Array out(2);
  out[0] = a;
  out[1] = b;
  return out;
}
const auto effort = two<AxisEffort>;
const auto speed = two<AxisVelocity>;

TEST(SlewLimiter, ChangeWithinTheLimit_PassesBitByBit) {
  const LimitedEffort out = limitSlew(effort(5.0, -1.0), effort(0.0, 0.0), effort(5.0, 1.0));
  EXPECT_EQ(out.effort[0], 5.0);
  EXPECT_EQ(out.effort[1], -1.0);
  EXPECT_EQ(out.faults, Fault::kNone);
  EXPECT_EQ(out.axis, -1);
}

TEST(SlewLimiter, ChangeBeyondTheLimit_IsHeldAndNamesTheAxis) {
  const LimitedEffort out = limitSlew(effort(1.0, -7.0), effort(0.5, -1.0), effort(5.0, 2.0));
  EXPECT_EQ(out.effort[0], 1.0);
  EXPECT_EQ(out.effort[1], -3.0);  // -1 - 2
  EXPECT_EQ(out.faults, Fault::kEffortSlew);
  EXPECT_EQ(out.axis, 1);
}

// A step of 20 N at 5 N a period is there in four.
TEST(SlewLimiter, Step_ArrivesAfterItsHeightOverTheLimit) {
  AxisEffort sent = effort(-10.0, 0.0);
  for (int k = 1; k <= 4; ++k) {
    sent = limitSlew(effort(10.0, 0.0), sent, effort(5.0, 5.0)).effort;
    EXPECT_EQ(sent[0], -10.0 + 5.0 * k);
  }
  EXPECT_EQ(limitSlew(effort(10.0, 0.0), sent, effort(5.0, 5.0)).faults, Fault::kNone);
}

TEST(PowerLimiter, BelowTheLimit_PassesBitByBit) {
  const LimitedEffort out =
      limitPower(effort(10.0, 2.0), effort(0.0, 0.0), speed(1.0, 1.0), 12.0 + 1e-9);
  EXPECT_EQ(out.effort[0], 10.0);
  EXPECT_EQ(out.effort[1], 2.0);
  EXPECT_EQ(out.faults, Fault::kNone);
}

// 10 N at 1 m/s and 2 N·m at 5 rad/s are 20 W; of 5 W a quarter is left of both.
TEST(PowerLimiter, AboveTheLimit_ScalesWhatPushesByOneFactor) {
  const LimitedEffort out = limitPower(effort(10.0, 2.0), effort(0.0, 0.0), speed(1.0, 5.0), 5.0);
  EXPECT_NEAR(out.effort[0], 2.5, tolerance(1e-12));
  EXPECT_NEAR(out.effort[1], 0.5, tolerance(1e-12));
  EXPECT_EQ(out.faults, Fault::kPowerLimit);
}

TEST(PowerLimiter, WhatBrakes_StaysAndIsNotCreditedToTheOthers) {
  const LimitedEffort out = limitPower(effort(10.0, -9.0), effort(0.0, 0.0), speed(1.0, 1.0), 5.0);
  EXPECT_NEAR(out.effort[0], 5.0, tolerance(1e-12));
  EXPECT_EQ(out.effort[1], -9.0);
}

TEST(PowerLimiter, WeightOfTheDevice_IsCarriedWhateverTheMotion) {
  const LimitedEffort out = limitPower(effort(8.0, 0.0), effort(8.0, 0.0), speed(100.0, 0.0), 1.0);
  EXPECT_EQ(out.effort[0], 8.0);
  EXPECT_EQ(out.faults, Fault::kNone);
}

TEST(PowerLimiter, AtRestOrWithoutALimit_LetsEverythingPass) {
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(limitPower(effort(20.0, 1.0), effort(0.0, 0.0), speed(0.0, 0.0), 1.0).effort[0], 20.0);
  EXPECT_EQ(limitPower(effort(20.0, 1.0), effort(0.0, 0.0), speed(9.0, 9.0), none).effort[0], 20.0);
}

TEST(PowerLimiter, WhateverComes_GivesAtMostTheLimitAndTurnsNothingRound) {
  rc::check([](std::array<short, 4> raw, unsigned char watt) {
    const AxisEffort wanted = effort(raw[0] * 1e-3, raw[1] * 1e-3);
    const AxisVelocity qd = speed(raw[2] * 1e-3, raw[3] * 1e-3);
    const double limit_w = 0.01 + 0.1 * watt;
    const LimitedEffort out = limitPower(wanted, effort(0.0, 0.0), qd, limit_w);
    double given_w = 0.0;
    for (int a = 0; a < 2; ++a) {
      given_w += std::max(out.effort[a] * qd[a], 0.0);
      RC_ASSERT(std::abs(out.effort[a]) <= std::abs(wanted[a]));
      RC_ASSERT(out.effort[a] * wanted[a] >= 0.0);
    }
    RC_ASSERT(given_w <= limit_w + 1e-9);
  });
}

}  // namespace
}  // namespace wholehand::test
