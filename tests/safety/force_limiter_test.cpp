#include "safety/force_limiter.hpp"

#include "realtime/allocation_counter.hpp"
#include "support/axes.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <cstdint>
#include <cstring>

namespace wholehand::test {
namespace {

/// Efforts of three axes against limits of 20, 0.6 and 1.
LimitedEffort limited(double a, double b, double c) {
  return limitEffort(of<AxisEffort>(a, b, c), of<AxisEffort>(20.0, 0.6, 1.0));
}

void expectEffort(const LimitedEffort& out, double a, double b, double c) {
  EXPECT_EQ(out.effort.vec(), of<AxisEffort>(a, b, c).vec());
}

TEST(ForceLimiter, EffortsWithinLimits_PassUntouchedWithoutFault) {
  const LimitedEffort out = limited(20.0, -0.6, 0.0);
  expectEffort(out, 20.0, -0.6, 0.0);
  EXPECT_EQ(out.faults, Fault::kNone);
}

TEST(ForceLimiter, EffortsBeyondLimits_AreClampedAndReportedWithoutStopping) {
  const LimitedEffort out = limited(20.001, -7.0, 0.1);
  expectEffort(out, 20.0, -0.6, 0.1);
  EXPECT_EQ(out.faults, Fault::kEffortLimit);
  EXPECT_FALSE(any(out.faults & kStopping));
}

TEST(ForceLimiter, NonFiniteEffort_BecomesZeroAndStops) {
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    const LimitedEffort out = limited(1.0, bad, 2.0);
    expectEffort(out, 1.0, 0.0, 1.0);
    EXPECT_EQ(out.faults, Fault::kNonFiniteEffort | Fault::kEffortLimit);
    EXPECT_TRUE(any(out.faults & kStopping));
  }
}

TEST(ForceLimiter, LimitThatIsNoLimit_LetsNothingThrough) {
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

TEST(ForceLimiter, AnyBits_ComeOutFiniteAndWithinLimits) {
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
