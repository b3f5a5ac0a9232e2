#include "loop/realtime/allocation_counter.hpp"
#include "loop/safety/force_limiter.hpp"
#include "support/axes.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

namespace wholehand::test {
namespace {

const auto force = of<AxisEffort, double, double>;
const auto rate = of<AxisVelocity, double, double>;

/// A window of sent efforts, the oldest first.
SlewWindow sentBefore(const std::vector<AxisEffort>& efforts) {
  SlewWindow window(4);
  for (const AxisEffort& e : efforts) window.note(e);
  return window;
}

TEST(SlewLimiter, ChangeWithinTheLimit_PassesToTheBit) {
  const LimitedEffort out =
      limitSlew(force(5.0, -1.0), sentBefore({force(0.0, 0.0)}), force(5.0, 1.0));
  EXPECT_EQ(out.effort.vec(), force(5.0, -1.0).vec());
  EXPECT_EQ(out.faults, Fault::kNone);
  EXPECT_EQ(out.axis, -1);
}

TEST(SlewLimiter, ChangeBeyondTheLimit_IsLimitedAndNamesTheAxis) {
  const LimitedEffort out =
      limitSlew(force(1.0, -7.0), sentBefore({force(0.5, -1.0)}), force(5.0, 2.0));
  EXPECT_EQ(out.effort.vec(), force(1.0, -3.0).vec());  // -1 - 2
  EXPECT_EQ(out.faults, Fault::kEffortSlew);
  EXPECT_EQ(out.axis, 1);
}

// A step of 20 N at 5 N per period takes four periods.
TEST(SlewLimiter, Step_ArrivesAfterItsHeightDividedByTheLimit) {
  AxisEffort sent = force(-10.0, 0.0);
  for (int k = 1; k <= 4; ++k) {
    sent = limitSlew(force(10.0, 0.0), sentBefore({sent}), force(5.0, 5.0)).effort;
    EXPECT_EQ(sent[0], -10.0 + 5.0 * k);
  }
  EXPECT_EQ(limitSlew(force(10.0, 0.0), sentBefore({sent}), force(5.0, 5.0)).faults, Fault::kNone);
}

// Four ticks in the window: one of them may make a step of the whole limit, and no further change
// follows until the effort before it has left the window.
TEST(SlewLimiter, StepAtAHighRate_IsNoHigherThanInAMillisecond) {
  SlewWindow window(4);
  AxisEffort sent = force(0.0, 0.0);
  for (int k = 0; k < 12; ++k) {
    window.note(sent);
    sent = limitSlew(force(100.0, -1.0), window, force(5.0, 1.0)).effort;
    EXPECT_EQ(sent[0], 5.0 * (1 + k / 4)) << k;
    EXPECT_EQ(sent[1], -1.0) << k;
  }
}

TEST(SlewLimiter, Window_IsAMillisecondOrOneTick) {
  EXPECT_EQ(slewTicks(1e-2), 1);
  EXPECT_EQ(slewTicks(1.0 / 1500.0), 1);
  EXPECT_EQ(slewTicks(1e-3), 1);
  EXPECT_EQ(slewTicks(1.0 / 2000.0), 2);
  EXPECT_EQ(slewTicks(1.0 / 8000.0), 8);
  EXPECT_EQ(slewTicks(1.0 / 16000.0), kMostSlewTicks);
}

// A device that refused efforts holds another one than was sent: the limiter continues from the
// held one.
TEST(SlewLimiter, EffortsFurtherApartThanTheLimit_ContinueFromTheLast) {
  const SlewWindow window = sentBefore({force(0.0, 0.0), force(20.0, 0.0)});
  EXPECT_EQ(limitSlew(force(30.0, 0.0), window, force(5.0, 5.0)).effort[0], 20.0);
  EXPECT_EQ(limitSlew(force(0.0, 0.0), window, force(5.0, 5.0)).effort[0], 15.0);
}

// In any window of a millisecond, efforts differ by at most the limit, for any wanted effort.
TEST(SlewLimiter, AnyWantedEffort_DiffersByAtMostTheLimitWithinTheWindow) {
  EXPECT_TRUE(rc::check([](const std::vector<int>& wanted) {
    const auto ticks = *rc::gen::inRange(1, kMostSlewTicks + 1);
    SlewWindow window(ticks);
    std::vector<double> sent = {0.0};
    for (const int effort_n : wanted) {
      window.note(AxisEffort(1, sent.back()));
      const AxisEffort next(1, static_cast<double>(effort_n));
      sent.push_back(limitSlew(next, window, AxisEffort(1, 5.0)).effort[0]);
      const auto from = sent.end() - std::min<std::ptrdiff_t>(ticks + 1, std::ssize(sent));
      const auto [least, most] = std::minmax_element(from, sent.end());
      RC_ASSERT(*most - *least <= 5.0 + 1e-9);
    }
  }));
}

TEST(PowerLimiter, PowerBelowTheLimit_PassesToTheBit) {
  const LimitedEffort out =
      limitPower(force(10.0, 2.0), force(0.0, 0.0), rate(1.0, 1.0), 12.0 + 1e-9);
  EXPECT_EQ(out.effort.vec(), force(10.0, 2.0).vec());
  EXPECT_EQ(out.faults, Fault::kNone);
}

// 10 N at 1 m/s and 2 N·m at 5 rad/s are 20 W; with a limit of 5 W a quarter of both is left.
TEST(PowerLimiter, PowerAboveTheLimit_IsSharedEqually) {
  const LimitedEffort out = limitPower(force(10.0, 2.0), force(0.0, 0.0), rate(1.0, 5.0), 5.0);
  EXPECT_NEAR(out.effort[0], 2.5, tolerance(1e-12));
  EXPECT_NEAR(out.effort[1], 0.5, tolerance(1e-12));
  EXPECT_EQ(out.faults, Fault::kPowerLimit);
}

// 1 W and 20 W within 5 W: the first keeps its effort, the other gets the remaining 4 W.
TEST(PowerLimiter, AxisWithLittlePower_KeepsItsEffort) {
  const LimitedEffort out = limitPower(force(1.0, 20.0), force(0.0, 0.0), rate(1.0, 1.0), 5.0);
  EXPECT_EQ(out.effort[0], 1.0);
  EXPECT_NEAR(out.effort[1], 4.0, tolerance(1e-12));
  EXPECT_EQ(out.axis, 1);
}

// 1, 5 and 10 W with 9 W allowed: an equal part is 3; the first leaves 2 of it to the others, 4
// each.
TEST(PowerLimiter, UnusedShareOfOneAxis_GoesToTheOthers) {
  const LimitedEffort out = limitPower(of<AxisEffort>(1.0, -2.5, 5.0), AxisEffort(3),
                                       of<AxisVelocity>(1.0, -2.0, 2.0), 9.0);
  EXPECT_EQ(out.effort[0], 1.0);
  EXPECT_NEAR(out.effort[1], -2.0, tolerance(1e-12));
  EXPECT_NEAR(out.effort[2], 2.0, tolerance(1e-12));
  EXPECT_EQ(out.axis, 1);
}

// Velocity noise around 0: the power of 10 N at a nanometre per second need not be limited.
TEST(PowerLimiter, AxisThatHardlyMoves_KeepsItsEffortForAnyPowerOfTheOthers) {
  for (const double noise : {1e-9, -1e-9}) {
    const LimitedEffort out = limitPower(force(10.0, 2.0), force(0.0, 0.0), rate(noise, 10.0), 5.0);
    EXPECT_EQ(out.effort[0], 10.0);
    EXPECT_NEAR(out.effort[1] * 10.0, 5.0 - std::max(10.0 * noise, 0.0), tolerance(1e-12));
    EXPECT_EQ(out.axis, 1);
  }
}

TEST(PowerLimiter, BrakingAxis_KeepsItsEffortAndGivesNoCredit) {
  const LimitedEffort out = limitPower(force(10.0, -9.0), force(0.0, 0.0), rate(1.0, 1.0), 5.0);
  EXPECT_NEAR(out.effort[0], 5.0, tolerance(1e-12));
  EXPECT_EQ(out.effort[1], -9.0);
}

TEST(PowerLimiter, NeutralEffort_IsKeptInAnyMotion) {
  const LimitedEffort out = limitPower(force(8.0, 0.0), force(8.0, 0.0), rate(100.0, 0.0), 1.0);
  EXPECT_EQ(out.effort[0], 8.0);
  EXPECT_EQ(out.faults, Fault::kNone);
}

TEST(PowerLimiter, AtRestOrWithoutALimit_PassesEverything) {
  const double none = std::numeric_limits<double>::infinity();
  EXPECT_EQ(limitPower(force(20.0, 1.0), force(0.0, 0.0), rate(0.0, 0.0), 1.0).effort[0], 20.0);
  EXPECT_EQ(limitPower(force(20.0, 1.0), force(0.0, 0.0), rate(9.0, 9.0), none).effort[0], 20.0);
}

/// Σ min(pᵢ, share): the power given with this cap.
double givenWith(const AxisEffort& wanted, const AxisVelocity& qd, double share_w) {
  double given_w = 0.0;
  for (int a = 0; a < wanted.size(); ++a) {
    given_w += std::clamp(wanted[a] * qd[a], 0.0, share_w);
  }
  return given_w;
}

TEST(PowerLimiter, AnyInput_GivesTheLimitByOneCapAndReversesNoEffort) {
  rc::check([](const std::array<std::array<short, 2>, 6>& raw, unsigned char watt) {
    AxisEffort wanted(6);
    AxisVelocity qd(6);
    for (int a = 0; a < 6; ++a) {
      wanted[a] = raw[a][0] * 1e-3;
      qd[a] = raw[a][1] * 1e-3;
    }
    const double limit_w = 0.01 + 0.1 * watt;
    const double wanted_w = givenWith(wanted, qd, 1e9);
    const AxisEffort out = limitPower(wanted, AxisEffort(6), qd, limit_w).effort;
    // The cap by bisection, for comparison.
    double low_w = 0.0, high_w = wanted_w + 1.0;
    for (int i = 0; i < 100; ++i) {
      const double middle_w = 0.5 * (low_w + high_w);
      (givenWith(wanted, qd, middle_w) < limit_w ? low_w : high_w) = middle_w;
    }
    for (int a = 0; a < 6; ++a) {
      const double power_w = wanted[a] * qd[a];
      RC_ASSERT(std::abs(out[a]) <= std::abs(wanted[a]));
      RC_ASSERT(out[a] * wanted[a] >= 0.0);
      RC_ASSERT(std::abs(out[a] * qd[a] - std::min(power_w, low_w)) <= 1e-9 * (1.0 + wanted_w));
    }
    RC_ASSERT(std::abs(givenWith(out, qd, 1e9) - std::min(wanted_w, limit_w)) <= 1e-9);
  });
}

/// Limits the efforts of three axes to 20, 0.6 and 1.
LimitedEffort limited(double a, double b, double c) {
  return limitEffort(of<AxisEffort>(a, b, c), of<AxisEffort>(20.0, 0.6, 1.0));
}

void expectEffort(const LimitedEffort& out, double a, double b, double c) {
  EXPECT_EQ(out.effort.vec(), of<AxisEffort>(a, b, c).vec());
}

TEST(ForceLimiter, EffortsWithinLimits_PassUnchangedWithoutFault) {
  const LimitedEffort out = limited(20.0, -0.6, 0.0);
  expectEffort(out, 20.0, -0.6, 0.0);
  EXPECT_EQ(out.faults, Fault::kNone);
}

TEST(ForceLimiter, EffortsBeyondLimits_AreClampedAndReportedWithoutStopping) {
  const LimitedEffort out = limited(20.001, -7.0, 0.1);
  expectEffort(out, 20.0, -0.6, 0.1);
  EXPECT_EQ(out.faults, Fault::kEffortLimit);
  EXPECT_FALSE(any(out.faults & kStoppingFaults));
}

TEST(ForceLimiter, NonFiniteEffort_BecomesZeroAndStops) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    const LimitedEffort out = limited(1.0, bad, 2.0);
    expectEffort(out, 1.0, 0.0, 1.0);
    EXPECT_EQ(out.faults, Fault::kNonFiniteEffort | Fault::kEffortLimit);
    EXPECT_TRUE(any(out.faults & kStoppingFaults));
  }
}

TEST(ForceLimiter, InvalidLimit_PassesNothing) {
  for (const double bad : {std::nan(""), -5.0, 0.0}) {
    const LimitedEffort out = limitEffort(AxisEffort(1, 3.0), AxisEffort(1, bad));
    EXPECT_EQ(out.effort[0], 0.0);
    EXPECT_EQ(out.faults, Fault::kEffortLimit);
  }
}

TEST(ForceLimiter, MissingEffort_IsZero) {
  const LimitedEffort out = limitEffort(AxisEffort(1, 3.0), AxisEffort(3, 5.0));
  EXPECT_EQ(out.effort.size(), 3);
  EXPECT_EQ(out.effort[0], 3.0);
  EXPECT_EQ(out.effort[2], 0.0);
}

TEST(ForceLimiter, AnyBitPattern_IsFiniteAndWithinLimits) {
  EXPECT_TRUE(rc::check("bound", [](std::uint64_t effort_bits, std::uint64_t limit_bits) {
    double effort = 0.0, limit = 0.0;  // every bit pattern: NaNs, infinities, subnormals
    std::memcpy(&effort, &effort_bits, sizeof effort);
    std::memcpy(&limit, &limit_bits, sizeof limit);
    const LimitedEffort out = limitEffort(AxisEffort(1, effort), AxisEffort(1, limit));
    RC_ASSERT(std::isfinite(out.effort[0]));
    RC_ASSERT(std::abs(out.effort[0]) <= (limit > 0.0 ? limit : 0.0));
    RC_ASSERT(out.effort[0] == effort || any(out.faults));
  }));
}

TEST(ForceLimiter, InTheTick_DoesNotAllocate) {
  const AllocationScope scope;
  const LimitedEffort out = limited(1.0, 2.0, 3.0);
  EXPECT_EQ(scope.allocations(), 0U);
  EXPECT_EQ(out.effort[2], 1.0);
}

}  // namespace
}  // namespace wholehand::test
