// The direct solution of an island: impulses of closed forms.
#include "loop/physics/bullet/island_newton.hpp"

#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace wholehand::bullet {
namespace {

constexpr double kFall_m_s = 9.81e-3;  // gravity in a step of 1 ms

/// Bodies that fall at kFall_m_s, one on the other, with one contact between two through their
/// centres. Body k is the `numbers[k]`-th of the solver.
void pile(IslandNewton& newton, const std::vector<double>& masses_kg,
          const std::vector<std::size_t>& numbers, double aside_m_s, double friction) {
  newton.begin(static_cast<int>(masses_kg.size()));
  for (std::size_t k = 0; k < masses_kg.size(); ++k) {
    const int above = static_cast<int>(numbers[k]);
    const int below = k == 0 ? -1 : static_cast<int>(numbers[k - 1]);
    IslandNewton::Contact& contact = *newton.add(above, below);
    contact.friction = friction;
    const std::array axes{2, 0, 1};  // normal along z, tangents along x and y
    for (int r = 0; r < 3; ++r) {
      contact.along_a[r][axes[r]] = 1.0 / std::sqrt(masses_kg[k]);
      if (k > 0) contact.along_b[r][axes[r]] = -1.0 / std::sqrt(masses_kg[k - 1]);
    }
    contact.goal = {k == 0 ? kFall_m_s : 0.0, k == 0 ? -aside_m_s : 0.0, 0.0};
    contact.start = {0.0, 0.0, 0.0};
  }
}

/// A contact carries the weight of all bodies above it: Σ m g T.
TEST(IslandNewton, BodiesOnEachOther_CarryTheWeightAboveThem) {
  auto random = test::seededRandom(6102);
  static IslandNewton newton;
  for (int i = 0; i < 100; ++i) {
    const std::size_t count = 1 + random() % IslandNewton::kMostBodies;
    std::vector<double> masses_kg(count);
    for (double& m : masses_kg) m = std::exp(test::uniform(random, std::log(1e-3), 0.0));
    pile(newton, masses_kg, test::sampleOf(count, count, random), 0.0, 0.5);
    // Minimum degree leaves a chain a chain: 3 products for each body but the last.
    EXPECT_EQ(newton.order(), 3 * static_cast<int>(count) - 2);
    ASSERT_TRUE(newton.solve(40));
    double above_kg = 0.0;
    for (std::size_t k = count; k-- > 0;) {
      above_kg += masses_kg[k];
      EXPECT_NEAR(newton.contact(static_cast<int>(k)).impulse[0], above_kg * kFall_m_s,
                  1e-4 * above_kg * kFall_m_s);
    }
  }
}

/// A pile that slides as a whole at 1 m/s: the ground rubs with μ times the whole weight, and
/// every contact above with μ times the weight above it, the share that slows what lies there
/// alike.
TEST(IslandNewton, PileThatSlides_IsSlowedByItsWeightTimesFriction) {
  auto random = test::seededRandom(6103);
  static IslandNewton newton;
  for (int i = 0; i < 50; ++i) {
    const std::size_t count = 1 + random() % 12;
    std::vector<double> masses_kg(count);
    for (double& m : masses_kg) m = std::exp(test::uniform(random, std::log(1e-2), 0.0));
    double whole_kg = 0.0;
    for (const double m : masses_kg) whole_kg += m;
    const double friction = test::uniform(random, 0.1, 0.8);
    pile(newton, masses_kg, test::sampleOf(count, count, random), 1.0, friction);
    ASSERT_GT(newton.order(), 0);
    ASSERT_TRUE(newton.solve(40));
    const auto& ground = newton.contact(0);
    const double limit_ns = friction * whole_kg * kFall_m_s;
    EXPECT_NEAR(ground.impulse[1], -limit_ns, 1e-4 * limit_ns);
    EXPECT_NEAR(ground.impulse[2], 0.0, 1e-4 * limit_ns);
  }
}

}  // namespace
}  // namespace wholehand::bullet
