#include "control/passivity.hpp"

#include "control/critical_damping.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace wholehand::test {
namespace {

AxisLoop loop(double k_ps, int delay, double filter_hz, double gamma) {
  AxisLoop l;
  l.mass = 0.5;
  l.damping = 1.0;
  l.delay_ticks = delay;
  l.k_pm = 1000.0;
  l.gamma = gamma;
  l.k_ps_per_s2 = k_ps;
  l.k_ds_per_s = criticalDamping(k_ps, 1e-3);
  l.filter_tau_s = 1.0 / (2.0 * std::numbers::pi * filter_hz);
  return l;
}

TEST(RequiredDamping, ReferenceTable_IsMetWithinOnePercent) {
  struct Row {
    double k_ps;
    int delay;
    double filter_hz;
    double gamma_0, gamma_half, gamma_1;
  };
  // Reference: an independent program (20,000 frequencies). K_pm 1000 N/m, Φ = 0.
  const Row rows[] = {{400, 0, 30, 24.88, 6.22, 9.21},    {900, 1, 30, 17.05, 7.21, 13.21},
                      {2500, 0, 30, 9.88, 2.47, 4.06},    {2500, 1, 30, 10.39, 4.78, 8.36},
                      {2500, 1, 100, 10.39, 9.18, 17.36}, {10000, 0, 30, 4.88, 1.44, 2.37},
                      {10000, 1, 30, 5.41, 2.98, 4.73},   {40000, 1, 30, 2.94, 2.11, 2.95}};
  for (const Row& row : rows) {
    const auto required = [&](double gamma) {
      return requiredDamping(loop(row.k_ps, row.delay, row.filter_hz, gamma));
    };
    EXPECT_NEAR(required(0.0), row.gamma_0, 0.01 * row.gamma_0) << row.k_ps << " " << row.delay;
    EXPECT_NEAR(required(0.5), row.gamma_half, 0.01 * row.gamma_half) << row.k_ps;
    EXPECT_NEAR(required(1.0), row.gamma_1, 0.01 * row.gamma_1) << row.k_ps << " " << row.delay;
  }
}

TEST(RequiredDamping, PaperLaw_TendsToItsDirectCurrentLimit) {
  // Closed form at frequency zero, γ = 0, n = 0: K T/2 + K (k_d − k_p T)² / (4 k_p (k_d − k_p
  // T/2)).
  const double kp = 2500.0, kd = criticalDamping(kp, 1e-3);
  const double e = kd - kp * 1e-3;
  const double limit = 1000.0 * (0.5e-3 + e * e / (4.0 * kp * (kd - kp * 0.5e-3)));
  EXPECT_NEAR(requiredDamping(loop(kp, 0, 30.0, 0.0)), limit, 1e-3 * limit);
}

TEST(RequiredDamping, AvatarThatIsActiveItself_CannotBeSaved) {
  AxisLoop l = loop(2500.0, 0, 30.0, 0.0);
  l.k_ds_per_s = 1.0;  // below T k_p / 2 = 1.25
  EXPECT_EQ(requiredDamping(l), HUGE_VAL);
}

}  // namespace
}  // namespace wholehand::test
