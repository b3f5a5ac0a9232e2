// Coulomb's law at one contact, by its optimality conditions (Moré, Sorensen 1983).
#include "loop/physics/bullet/row_arithmetic.hpp"
#include "support/seed.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::bullet {
namespace {

using test::uniform;

struct Contact {
  Eigen::Matrix2d yield;
  Eigen::Vector2d was, lacking, is;
  double limit = 0.0;

  explicit Contact(std::mt19937_64& random) {
    // The two mobilities of a contact differ by up to ten times.
    const double turn = uniform(random, 0.0, 3.0), small = uniform(random, 0.1, 2.0);
    const double large = small * uniform(random, 1.0, 10.0), c = std::cos(turn), s = std::sin(turn);
    Eigen::Matrix2d axes;
    axes << c, -s, s, c;
    yield = axes * Eigen::Vector2d(small, large).asDiagonal() * axes.transpose();
    was = {uniform(random, -1.0, 1.0), uniform(random, -1.0, 1.0)};
    lacking = {uniform(random, -3.0, 3.0), uniform(random, -3.0, 3.0)};
    limit = random() % 5 == 0 ? 0.0 : std::exp(uniform(random, -6.0, 2.0));
  }

  void solve() {
    const Eigen::Matrix2d mass = yield.inverse();
    const FrictionDisc<double> disc{yield(0, 0), yield(0, 1), yield(1, 1), mass(0, 0),
                                    mass(0, 1),  mass(1, 1),  limit};
    disc.solve(was[0], was[1], lacking[0], lacking[1], is[0], is[1]);
  }
};

TEST(FrictionDisc, RandomContact_StopsTheSlipOrOpposesItAtTheLimit) {
  auto random = test::seededRandom(3620);
  int stuck = 0, slid = 0;
  for (int i = 0; i < 5'000; ++i) {
    Contact c(random);
    c.solve();
    const Eigen::Vector2d slip = c.yield * (c.is - c.was) - c.lacking;  // remaining slip
    ASSERT_LE(c.is.norm(), c.limit * (1.0 + 1e-12));
    if (c.is.norm() < c.limit * (1.0 - 1e-9)) {
      ++stuck;
      ASSERT_LE(slip.norm(), 1e-12);
    } else if (c.limit > 0.0) {
      ++slid;
      const double across = c.is[0] * slip[1] - c.is[1] * slip[0];
      ASSERT_LE(c.is.dot(slip), 1e-12);
      if (slip.norm() < 1e-3) continue;
      // Three steps leave a hundredth of a degree if the limit is a thousandth of the impulse that
      // stops it.
      ASSERT_LE(std::abs(across), 0.01 * c.is.norm() * slip.norm());
    }
  }
  EXPECT_GT(stuck, 500);
  EXPECT_GT(slid, 500);
}

TEST(FrictionDisc, FourContactsAtOnce_GiveTheBitsOfEach) {
  auto random = test::seededRandom(3621);
  for (int i = 0; i < 500; ++i) {
    std::vector<Contact> each;
    for (int k = 0; k < 4; ++k) each.emplace_back(random);
    FrictionDisc<FourNumbers> disc;
    FourNumbers was_1, was_2, lacking_1, lacking_2, is_1, is_2;
    for (int k = 0; k < 4; ++k) {
      Contact& c = each[k];
      c.solve();
      const Eigen::Matrix2d mass = c.yield.inverse();
      disc.yield_11[k] = c.yield(0, 0), disc.yield_12[k] = c.yield(0, 1);
      disc.yield_22[k] = c.yield(1, 1), disc.mass_11[k] = mass(0, 0);
      disc.mass_12[k] = mass(0, 1), disc.mass_22[k] = mass(1, 1), disc.limit[k] = c.limit;
      was_1[k] = c.was[0], was_2[k] = c.was[1];
      lacking_1[k] = c.lacking[0], lacking_2[k] = c.lacking[1];
    }
    disc.solve(was_1, was_2, lacking_1, lacking_2, is_1, is_2);
    for (int k = 0; k < 4; ++k) {
      ASSERT_EQ(is_1[k], each[k].is[0]);
      ASSERT_EQ(is_2[k], each[k].is[1]);
    }
  }
}

}  // namespace
}  // namespace wholehand::bullet
