#include "patient/reach.hpp"

#include "patient/person_tools.hpp"

#include <gtest/gtest.h>

namespace wholehand::test {
namespace {

Moved after(Reach& reach, int periods, double period_s = 1e-3) {
  Moved m;
  for (int i = 0; i < periods; ++i) reach.advance(period_s, m.q, m.qd);
  return m;
}

TEST(Reach, FromRest_IsMinimumJerk) {
  Reach reach;
  reach.begin(pose(0.1, 0.0), AxisVelocity(2), pose(0.3, -0.4), 1.0);
  const Moved half = after(reach, 500);
  // Flash and Hogan 1985: half way at half time, peak speed 15/8 of the mean, there.
  EXPECT_NEAR(half.q[0], 0.2, 1e-12);
  EXPECT_NEAR(half.qd[1], -15.0 / 8.0 * 0.4, 1e-12);
  EXPECT_FALSE(reach.done());
  const Moved end = after(reach, 501);
  EXPECT_TRUE(reach.done());
  EXPECT_EQ(end.q[0], 0.3);
  EXPECT_EQ(end.qd[1], 0.0);
}

TEST(Reach, BegunOnTheWay_GoesOnAsFastAndComesToRest) {
  Reach reach;
  AxisVelocity going(2);
  going[0] = 0.5;
  reach.begin(pose(0.0, 0.0), going, pose(0.1, 0.0), 0.8);
  Moved before = after(reach, 1);
  EXPECT_NEAR(before.q[0], 0.5e-3, 1e-6);
  EXPECT_NEAR(before.qd[0], 0.5, 2e-3);
  for (int k = 0; k < 900; ++k) {
    const Moved now = after(reach, 1);
    // The trapezoid rule is off by T³/12 of the jerk, at most a few hundred here.
    ASSERT_NEAR(now.q[0] - before.q[0], 0.5e-3 * (now.qd[0] + before.qd[0]), 1e-7) << k;
    before = now;
  }
  EXPECT_EQ(before.q[0], 0.1);
}

TEST(Reach, AxisWithItsOwnTime_MovesThenOnly) {
  Reach reach;
  reach.begin(pose(0.0, 0.0), AxisVelocity(2), pose(1.0, 1.0), 1.0);
  reach.during(0, 0.0, 0.4);
  reach.during(1, 0.6, 1.0);
  const Moved early = after(reach, 400);
  EXPECT_EQ(early.q[0], 1.0);
  EXPECT_EQ(early.q[1], 0.0);
  const Moved late = after(reach, 400);
  EXPECT_NEAR(late.q[1], 0.5, 1e-9);
}

}  // namespace
}  // namespace wholehand::test
