// Why the effort is written before the world is stepped (docs/adr/0002-write-before-step.md).
#include "control/stability.hpp"
#include "support/constants.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace wholehand::test {
namespace {

constexpr double kMass_kg = 0.4, kDamping_n_s_m = 2.0;

/// Exact motion of m v' = f - b v over a time, as a matrix over [x, v, f].
Eigen::Matrix3d held(double time_s) {
  const double rate_per_s = kDamping_n_s_m / kMass_kg;
  const double travel_s = (1.0 - std::exp(-rate_per_s * time_s)) / rate_per_s;
  Eigen::Matrix3d out = Eigen::Matrix3d::Identity();
  out.row(0) << 1.0, travel_s, (time_s - travel_s) / kDamping_n_s_m;
  out.row(1) << 0.0, std::exp(-rate_per_s * time_s), travel_s / kMass_kg;
  return out;
}

/// A device against a spring to a rigid stop: one period, in which the effort that was computed
/// from the position at its start arrives `late_s` after it.
Eigen::Matrix3d onePeriod(double stiffness_n_m, double late_s) {
  Eigen::Matrix3d computed = Eigen::Matrix3d::Zero();
  computed(2, 0) = -stiffness_n_m;  // of the position at the start of the period
  const Eigen::Matrix3d until = held(late_s);
  Eigen::Matrix3d renewed = until;
  renewed.row(2) = computed.row(2);
  return held(kPeriod_s - late_s) * renewed;
}

double largestStable(double late_s) {
  double stable = 1.0, unstable = 1e5;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (stable + unstable);
    (spectralRadius(onePeriod(middle, late_s)) < 1.0 ? stable : unstable) = middle;
  }
  return stable;
}

TEST(TickOrder, EffortThatWaitsForThePhysicsStep_LosesStiffness) {
  constexpr double kWrite_s = 0.02e-3;  // what writing itself takes
  double before_n_m = largestStable(kWrite_s);
  for (const double step_s : {0.0, 0.1e-3, 0.4e-3, 0.8e-3}) {
    const double stable_n_m = largestStable(kWrite_s + step_s);
    std::printf("figure: largest stable stiffness, effort written %.1f ms later = %.0f N/m\n",
                step_s * 1e3, stable_n_m);
    // The sampled-data limit of a rigid contact, K < b / (T/2 + delay).
    const double limit_n_m = kDamping_n_s_m / (0.5 * kPeriod_s + kWrite_s + step_s);
    EXPECT_NEAR(stable_n_m, limit_n_m, 0.02 * limit_n_m);
    if (step_s > 0.0) {
      EXPECT_LT(stable_n_m, 0.9 * before_n_m);
    }
    before_n_m = stable_n_m;
  }
}

}  // namespace
}  // namespace wholehand::test
