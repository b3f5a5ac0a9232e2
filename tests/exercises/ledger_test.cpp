#include "exercises/cocktail_bar/pouring.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace wholehand::test {
namespace {

std::vector<BarDispenser> dispensers(std::vector<double> start_l) {
  std::vector<BarDispenser> out(start_l.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i].start_l = start_l[i];
  return out;
}

TEST(Ledger, PouringMoreThanTheStepHolds_SpillsTheRest) {
  Ledger ledger;
  ledger.fill(dispensers({0.2}));
  EXPECT_NEAR(ledger.pour(0, 0.05, 2, 0.03, 1.0), 0.05, tolerance(1e-12));
  EXPECT_NEAR(ledger.layer_l(2), 0.03, tolerance(1e-12));
  EXPECT_NEAR(ledger.glass_l(), 0.03, tolerance(1e-12));
  EXPECT_NEAR(ledger.spilt_l(), 0.02, tolerance(1e-12));
  EXPECT_NEAR(ledger.left_l(0), 0.15, tolerance(1e-12));
}

TEST(Ledger, FullGlass_Overflows) {
  Ledger ledger;
  ledger.fill(dispensers({0.2}));
  (void)ledger.pour(0, 0.1, 0, 1.0, 0.08);
  EXPECT_NEAR(ledger.glass_l(), 0.08, tolerance(1e-12));
  EXPECT_NEAR(ledger.spilt_l(), 0.02, tolerance(1e-12));
  (void)ledger.pour(0, 0.01, 1, 1.0, 0.08);
  EXPECT_NEAR(ledger.glass_l(), 0.08, tolerance(1e-12));
  EXPECT_NEAR(ledger.spilt_l(), 0.03, tolerance(1e-12));
}

TEST(Ledger, EmptyDispenser_GivesOnlyItsContent) {
  Ledger ledger;
  ledger.fill(dispensers({0.01}));
  EXPECT_NEAR(ledger.spill(0, 0.5), 0.01, tolerance(1e-12));
  EXPECT_EQ(ledger.spill(0, 0.5), 0.0);
  EXPECT_EQ(ledger.left_l(0), 0.0);
}

TEST(Ledger, InvalidAmount_MovesNothing) {
  Ledger ledger;
  ledger.fill(dispensers({0.1}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ledger.spill(0, nan), 0.0);
  EXPECT_EQ(ledger.spill(0, -1.0), 0.0);
  (void)ledger.pour(0, 0.01, 0, nan, 1.0);
  EXPECT_EQ(ledger.glass_l(), 0.0);
  EXPECT_NEAR(ledger.spilt_l(), 0.01, tolerance(1e-12));
}

TEST(Ledger, MillionRandomMoves_ConserveTheVolume) {
  auto random = seededRandom(34);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Ledger ledger;
  ledger.fill(dispensers({0.35, 0.2, 1.0 / 3.0, 0.1}));
  const double start_l = 0.35 + 0.2 + 1.0 / 3.0 + 0.1;
  double worst_l = 0.0;
  for (int i = 0; i < cases(1'000'000); ++i) {
    const int d = static_cast<int>(random() % 4);
    const double volume_l = 1e-5 * unit(random) * unit(random);
    if (random() % 3 == 0) {
      (void)ledger.spill(d, volume_l);
    } else {
      (void)ledger.pour(d, volume_l, static_cast<int>(random() % kMaxSteps), 0.01 * unit(random),
                        0.14);
    }
    if (random() % 5000 == 0) ledger.newGlass();
    if (random() % 300'000 == 0) ledger.fill(dispensers({0.35, 0.2, 1.0 / 3.0, 0.1}));
    double left_l = 0.0;
    for (int k = 0; k < 4; ++k) left_l += ledger.left_l(k);
    worst_l = std::max(worst_l, std::abs(ledger.poured_l() + ledger.spilt_l() + left_l - start_l));
  }
  EXPECT_GT(ledger.poured_l(), 0.0);
  EXPECT_LE(worst_l, tolerance(2e-12));  // one picolitre: 1/3 l is rounded once
}

}  // namespace
}  // namespace wholehand::test
