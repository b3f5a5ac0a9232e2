#include "loop/safety/neutral_ramp.hpp"

#include "loop/realtime/allocation_counter.hpp"
#include "support/axes.hpp"
#include "support/constants.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

namespace wholehand::test {
namespace {

const NeutralRampConfig kRamp;

const AxisEffort kNeutral = of<AxisEffort>(4.0, -0.1);  // e.g. carries the device's own weight
const AxisEffort kWanted = of<AxisEffort>(-12.0, 0.5);

NeutralRampState tick(const NeutralRampState& s, const AxisEffort& wanted, bool stop, int k = 1) {
  return advanceRamp(s, wanted, kNeutral, stop ? StopAsked::kPlain : StopAsked::kNone, k, kPeriod_s,
                     kRamp);
}

NeutralRampState engaged() {
  NeutralRampState s = engageFrom(kNeutral);
  for (int k = 0; k < 300; ++k) s = tick(s, kWanted, false);
  return s;
}

double smooth(double u) {
  return u >= 1.0 ? 1.0 : 3.0 * u * u - 2.0 * u * u * u;
}

TEST(NeutralRamp, BeforeTheFirstTick_HoldsNeutral) {
  const NeutralRampState s = engageFrom(kNeutral);
  EXPECT_EQ(s.phase, RampPhase::kRendering);
  EXPECT_EQ(s.authority, 0.0);
  EXPECT_EQ(s.sent[0], 4.0);
  EXPECT_EQ(s.sent[1], -0.1);
}

TEST(NeutralRamp, StateThatWasNeverEngaged_SendsNeutralForAnyInput) {
  const NeutralRampState s = tick({}, kWanted, false);
  EXPECT_EQ(s.phase, RampPhase::kNeutral);
  EXPECT_EQ(s.sent[0], 4.0);
}

TEST(NeutralRamp, Engaging_RisesByTheSmoothstepAndEndsExactlyAtTheWantedEffort) {
  NeutralRampState s = engageFrom(kNeutral);
  for (int k = 1; k <= 250; ++k) {
    s = tick(s, kWanted, false);
    const double a = smooth(k * kPeriod_s / kRamp.engage_s);
    EXPECT_NEAR(s.authority, a, tolerance(1e-12));
    EXPECT_NEAR(s.sent[0], 4.0 + a * (-12.0 - 4.0), tolerance(1e-11));
  }
  EXPECT_EQ(s.sent[0], -12.0);
  EXPECT_EQ(s.sent[1], 0.5);
  EXPECT_EQ(s.authority, 1.0);
}

TEST(NeutralRamp, StallWhileEngaging_DoesNotEndInAStep) {
  NeutralRampState s = engageFrom(kNeutral);
  for (int k = 0; k < 50; ++k) s = tick(s, kWanted, false);
  const NeutralRampState next = tick(s, kWanted, false, 500);
  // The first step of the smoothstep, over a span of less than the 16 N from neutral to the wanted
  // effort.
  EXPECT_LE(std::abs(next.sent[0] - s.sent[0]), 16.0 * smooth(kPeriod_s / kRamp.engage_s));
}

TEST(NeutralRamp, Stop_FollowsTheSmoothstepFromTheLastEffortToExactlyNeutral) {
  NeutralRampState s = engaged();
  for (int k = 1; k <= 120; ++k) {
    s = tick(s, of<AxisEffort>(1e9, 1e9), true);  // the wanted effort is ignored now
    const double share = 1.0 - smooth(k * kPeriod_s / kRamp.ramp_s);
    EXPECT_NEAR(s.sent[0], 4.0 + share * (-12.0 - 4.0), tolerance(1e-11));
    EXPECT_NEAR(s.authority, share, tolerance(1e-12));
    EXPECT_EQ(s.phase, k < 80 ? RampPhase::kRamping : RampPhase::kNeutral) << k;
  }
  EXPECT_EQ(s.sent[0], 4.0);
  EXPECT_EQ(s.sent[1], -0.1);
  EXPECT_EQ(s.authority, 0.0);
}

TEST(NeutralRamp, FirstTickOfAStop_StaysNearTheLastValidEffort) {
  const NeutralRampState before = engaged();
  for (const int skipped :
       {0, 3, 80, 5000}) {  // a stall before the fault does not shorten the ramp
    const NeutralRampState s = tick(before, of<AxisEffort>(99.0, 99.0), true, 1 + skipped);
    EXPECT_EQ(s.phase, RampPhase::kRamping);
    EXPECT_NEAR(s.sent[0], -12.0, 16.0 * 3.0 * (1.0 / 80.0) * (1.0 / 80.0));  // 3u² of the span
    EXPECT_GT(s.sent[0], -12.0);
  }
}

TEST(NeutralRamp, AtNeutral_NeverRisesAgain) {
  NeutralRampState s = engaged();
  for (int k = 0; k < 200; ++k) s = tick(s, kWanted, k == 0);
  EXPECT_EQ(s.phase, RampPhase::kNeutral);  // although the stop lasted one tick only
  for (int k = 0; k < 200; ++k) {
    s = tick(s, kWanted, false);
    EXPECT_EQ(s.sent[0], 4.0);
  }
}

TEST(NeutralRamp, NonFiniteEffort_StopsAndIsNeverSent) {
  for (const double bad : {std::nan(""), HUGE_VAL}) {
    NeutralRampState s = tick(engaged(), of<AxisEffort>(bad, 0.0), false);
    EXPECT_EQ(s.phase, RampPhase::kRamping);
    EXPECT_TRUE(allFinite(s.sent));
  }
  const NeutralRampState missing = tick(engaged(), AxisEffort(1, 0.0), false);
  EXPECT_EQ(missing.phase, RampPhase::kRamping);
}

TEST(NeutralRamp, StopWhileEngaging_StartsFromTheLastSentEffort) {
  NeutralRampState s = engageFrom(kNeutral);
  for (int k = 0; k < 60; ++k) s = tick(s, kWanted, false);
  const NeutralRampState before = s;
  s = tick(s, kWanted, true);
  EXPECT_NEAR(s.sent[0], before.sent[0], 16.0 * 3.0 / 6400.0);
  EXPECT_LT(s.authority, before.authority);
  EXPECT_NEAR(s.authority, before.authority, 0.01);
}

TEST(NeutralRamp, RampSlowerThanAllowed_StillEndsIn100Milliseconds) {
  for (const double ramp_s : {5.0, 0.1, -1.0, std::nan("")}) {
    NeutralRampConfig slow;
    slow.ramp_s = ramp_s;
    NeutralRampState s = engaged();
    for (int k = 0; k < 100; ++k) {
      s = advanceRamp(s, kWanted, kNeutral, StopAsked::kPlain, 1, kPeriod_s, slow);
    }
    EXPECT_EQ(s.phase, RampPhase::kNeutral);
    EXPECT_EQ(s.sent[0], 4.0);
  }
}

// ---- after a stall, while rendering

const AxisEffort kWantedNow =
    of<AxisEffort>(9.0, -0.5);  // far from kWanted: the device has moved on

TEST(NeutralRamp, StallLongerThanTheGap_EngagesAgainFromTheHeldEffort) {
  NeutralRampState s = engaged();
  for (int k = 1; k <= 220; ++k) {
    s = tick(s, kWantedNow, false, k == 1 ? 200 : 1);
    const double a = smooth(k * kPeriod_s / kRamp.reengage_s);  // the first tick counts as one
    EXPECT_NEAR(s.authority, a, tolerance(1e-12)) << k;
    EXPECT_NEAR(s.sent[0], -12.0 + a * (9.0 + 12.0), tolerance(1e-11)) << k;
    EXPECT_NEAR(s.sent[1], 0.5 + a * (-0.5 - 0.5), tolerance(1e-12)) << k;
    EXPECT_EQ(s.phase, RampPhase::kRendering);
  }
  EXPECT_EQ(s.sent[0], 9.0);
  EXPECT_EQ(s.sent[1], -0.5);
  EXPECT_EQ(s.authority, 1.0);
}

TEST(NeutralRamp, GapOfFiveMilliseconds_IsNoStallAndOnePeriodMoreIs) {
  for (const int rate_khz : {1, 2, 4}) {
    const auto after = [&](int periods) {
      return advanceRamp(engaged(), kWantedNow, kNeutral, StopAsked::kNone, periods,
                         1e-3 / rate_khz, kRamp);
    };
    for (int periods = 1; periods <= 5 * rate_khz; ++periods) {
      EXPECT_EQ(after(periods).authority, 1.0) << periods << " periods at " << rate_khz << " kHz";
      EXPECT_EQ(after(periods).sent[0], 9.0);
    }
    const NeutralRampState stalled = after(5 * rate_khz + 1);
    EXPECT_LT(stalled.authority, 4e-3);
    // The first step of the smoothstep, over a span of 21 N.
    EXPECT_LE(std::abs(stalled.sent[0] + 12.0),
              21.0 * smooth(1e-3 / rate_khz / kRamp.reengage_s) + 1e-12);
  }
}

// A loop of 100 Hz is slow, but a normal period is no stall.
TEST(NeutralRamp, PeriodLongerThanTheGap_IsNoStall) {
  constexpr double kSlow_s = 0.01;
  NeutralRampState s = engageFrom(kNeutral);
  const auto tick = [&](int periods) {
    s = advanceRamp(s, kWanted, kNeutral, StopAsked::kNone, periods, kSlow_s, kRamp);
  };
  for (int k = 0; k < std::lround(kRamp.engage_s / kSlow_s) + 1; ++k) tick(1);
  EXPECT_EQ(s.authority, 1.0);
  EXPECT_EQ(s.sent[0], kWanted[0]);
  tick(2);
  EXPECT_LT(s.authority, 1.0) << "a period that is skipped is one";
}

TEST(NeutralRamp, RepeatedStalls_EachStartFromTheLastSentEffort) {
  NeutralRampState s = engaged();
  for (int k = 0; k < 400; ++k) {
    const AxisEffort& wanted = k % 2 == 0 ? kWantedNow : kWanted;
    const NeutralRampState next = tick(s, wanted, false, 50);
    const double first = smooth(kPeriod_s / kRamp.reengage_s);
    EXPECT_NEAR(next.sent[0], s.sent[0] + first * (wanted[0] - s.sent[0]), tolerance(1e-12)) << k;
    s = next;
  }
}

TEST(NeutralRamp, StopWhileEngagingAgain_RampsFromTheLastSentEffort) {
  NeutralRampState s = engaged();
  for (int k = 0; k < 15; ++k) s = tick(s, kWantedNow, false, k == 0 ? 200 : 1);
  const double held = s.sent[0];
  EXPECT_NEAR(held, -1.5, 1e-9);  // halfway from -12 to 9
  for (int k = 1; k <= 120; ++k) {
    s = tick(s, kWanted, true);
    const double share = 1.0 - smooth(k * kPeriod_s / kRamp.ramp_s);
    EXPECT_NEAR(s.sent[0], 4.0 + share * (held - 4.0), tolerance(1e-11)) << k;
    EXPECT_NEAR(s.authority, 0.5 * share, tolerance(1e-9)) << k;
  }
  EXPECT_EQ(s.phase, RampPhase::kNeutral);
  EXPECT_EQ(s.sent[0], 4.0);
}

/// Random efforts, a stop at a random tick and randomly skipped periods.
TEST(NeutralRamp, RandomRun_StaysWithinLimitsAndSlewAndIsNeutralIn100Milliseconds) {
  EXPECT_TRUE(rc::check("run", [] {
    const double limit = 0.01 * *rc::gen::inRange(1, 5000);
    const double neutral_effort = limit * (*rc::gen::inRange(-1000, 1001) / 1000.0);
    const AxisEffort neutral(1, neutral_effort);
    const int stop_at = *rc::gen::inRange(1, 400);
    const int rate_hz = *rc::gen::element(500, 1000, 4000);
    const double period_s = 1.0 / rate_hz;
    const bool by_nan = *rc::gen::arbitrary<bool>();
    NeutralRampState s = engageFrom(neutral);
    double since_stop_s = 0.0;
    for (int k = 0; k < stop_at + 420; ++k) {
      const bool stop = k == stop_at;
      double wanted = limit * (*rc::gen::inRange(-1000, 1001) / 1000.0);
      if (stop && by_nan) wanted = std::numeric_limits<double>::quiet_NaN();
      const int elapsed = *rc::gen::weightedElement<int>({{20, 1}, {2, 2}, {1, 9}});
      const NeutralRampState next = advanceRamp(
          s, AxisEffort(1, wanted), neutral, stop && !by_nan ? StopAsked::kPlain : StopAsked::kNone,
          elapsed, period_s, kRamp);
      RC_ASSERT(std::isfinite(next.sent[0]));
      RC_ASSERT(std::abs(next.sent[0]) <= limit);
      if (k < stop_at && elapsed * period_s > kRamp.gap_s) {
        // After a stall: at most the smoothstep's first step of the span.
        RC_ASSERT(std::abs(next.sent[0] - s.sent[0]) <=
                  smooth(period_s / kRamp.reengage_s) * std::abs(wanted - s.sent[0]) + 1e-12);
      }
      if (k >= stop_at) {
        const double counted_s = (k == stop_at ? 1 : elapsed) * period_s;
        if (k > stop_at) since_stop_s += elapsed * period_s;
        // Slew: the smoothstep's steepest slope, 1.5 of the span over ramp_s.
        const double span = std::abs(next.held[0] - neutral_effort);
        RC_ASSERT(std::abs(next.sent[0] - s.sent[0]) <=
                  1.5 * span * counted_s / kRamp.ramp_s + 1e-12);
        // Monotone towards neutral.
        RC_ASSERT(std::abs(next.sent[0] - neutral_effort) <= std::abs(s.sent[0] - neutral_effort));
        RC_ASSERT(next.authority <= s.authority);
        if (since_stop_s >= 0.1) RC_ASSERT(next.sent[0] == neutral_effort);
      }
      s = next;
    }
  }));
}

TEST(NeutralRamp, InTheTick_DoesNotAllocate) {
  NeutralRampState s = engaged();
  const AllocationScope scope;
  s = tick(s, kWanted, false);
  s = tick(s, kWanted, true);
  s = tick(s, kWanted, true);
  EXPECT_EQ(scope.allocations(), 0U);
  EXPECT_EQ(s.phase, RampPhase::kRamping);
}

}  // namespace
}  // namespace wholehand::test
