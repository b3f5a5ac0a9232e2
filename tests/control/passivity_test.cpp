#include "control/passivity.hpp"

#include "axis_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

TEST(RequiredDamping, PaperLaw_TendsToItsDirectCurrentLimit) {
  // Closed form at frequency zero, γ = 0, n = 0: K T/2 + K (k_d − k_p T)² / (4 k_p (k_d − k_p
  // T/2)).
  const double kp = 2500.0, kd = criticalDamping(kp, 1e-3);
  const double e = kd - kp * 1e-3;
  const double limit = 1000.0 * (0.5e-3 + e * e / (4.0 * kp * (kd - kp * 0.5e-3)));
  EXPECT_NEAR(requiredDamping(loopOf(0.5, 1.0, 0, 1000.0, 0.0, 30.0, kp)), limit, 1e-3 * limit);
}

TEST(RequiredDamping, AvatarThatIsActiveItself_CannotBeSaved) {
  AxisLoop l = loopOf(0.5, 1.0, 0, 1000.0, 0.0, 30.0);
  l.k_ds_per_s = 1.0;  // below T k_p / 2 = 1.25
  EXPECT_EQ(requiredDamping(l), HUGE_VAL);
}

}  // namespace
}  // namespace wholehand::test
