// The direct solution of an island: impulses of closed forms.
#include "loop/physics/bullet/island_newton.hpp"

#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
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
  // Of 20,000 such draws, a thousandfold mass on 32 bodies among them, one needed more steps; such
  // an island is left to the sweeps.
  int left_to_sweeps = 0;
  for (int i = 0; i < 100; ++i) {
    const std::size_t count = 1 + random() % IslandNewton::kMostBodies;
    std::vector<double> masses_kg(count);
    for (double& m : masses_kg) m = std::exp(test::uniform(random, std::log(1e-3), 0.0));
    pile(newton, masses_kg, test::sampleOf(count, count, random), 0.0, 0.5);
    // Minimum degree leaves a chain a chain: 3 products for each body but the last.
    EXPECT_EQ(newton.order(), 3 * static_cast<int>(count) - 2);
    if (!newton.solve(40)) {
      ++left_to_sweeps;
      continue;
    }
    double above_kg = 0.0;
    for (std::size_t k = count; k-- > 0;) {
      above_kg += masses_kg[k];
      EXPECT_NEAR(newton.contact(static_cast<int>(k)).impulse[0], above_kg * kFall_m_s,
                  1e-4 * above_kg * kFall_m_s);
    }
  }
  EXPECT_LE(left_to_sweeps, 1);
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
    // Every contact gives way by some 10⁻⁶ of the fall, and the bodies above it with it.
    const double off_ns = (1e-4 + 1e-5 * static_cast<double>(count)) * limit_ns;
    EXPECT_NEAR(ground.impulse[1], -limit_ns, off_ns);
    EXPECT_NEAR(ground.impulse[2], 0.0, off_ns);
  }
}

// Four corners bear a plate: their impulses are determined but for one number. Whatever they were
// before, and whatever the last digits of the gaps, each bears a quarter.
TEST(IslandNewton, PlateOnFourCorners_SharesItsLoad) {
  auto random = test::seededRandom(6105);
  static IslandNewton newton;
  double worst = 0.0;
  for (int i = 0; i < 10; ++i) {
    const double mass_kg = std::pow(10.0, test::uniform(random, -2.0, 1.0));
    // Half of its sides, in radii of gyration.
    const double x = test::uniform(random, 0.5, 1.7), y = test::uniform(random, 0.5, 1.7);
    const double quarter_ns = 0.25 * mass_kg * kFall_m_s, uneven = test::uniform(random, -1.0, 1.0);
    std::array<double, 4> impulse_ns{};
    for (int k = 0; k < 4; ++k)
      impulse_ns[k] = (k % 2 == 0 ? 1.0 + uneven : 1.0 - uneven) * quarter_ns;
    for (int step = 0; step < 4000; ++step) {
      newton.begin(1);
      for (int k = 0; k < 4; ++k) {
        IslandNewton::Contact& contact = *newton.add(0, -1);
        const double to_x = k == 0 || k == 3 ? x : -x, to_y = k < 2 ? y : -y;
        contact.along_a[0] = {0.0, 0.0, 1.0, to_y, -to_x, 0.0};
        for (double& along : contact.along_a[0]) along /= std::sqrt(mass_kg);
        contact.goal[0] = kFall_m_s + 1e-15 * (k % 2 == 0 ? 1.0 : -1.0);
        contact.start[0] = impulse_ns[k];
      }
      ASSERT_GT(newton.order(), 0);
      ASSERT_TRUE(newton.solve(40));
      for (int k = 0; k < 4; ++k) impulse_ns[k] = newton.contact(k).impulse[0];
    }
    for (const double is_ns : impulse_ns)
      worst = std::max(worst, std::abs(is_ns / quarter_ns - 1.0));
  }
  std::printf("figure: share of a corner, off a quarter of the load %.3g\n", worst);
  EXPECT_LE(worst, 1e-3);
}

/// A chain of bodies on three contacts each, with the hand on the last one; rows of any direction.
/// @return the wanted velocities
std::vector<std::array<double, 3>> grasp(IslandNewton& newton, int bodies,
                                         std::mt19937_64& random) {
  newton.begin(bodies + 1);
  std::vector<std::array<double, 3>> goals;
  for (int k = 0; k <= bodies; ++k) {
    for (int n = 0; n < 3; ++n) {
      IslandNewton::Contact& c = *newton.add(k - 1, k);
      c.friction = test::uniform(random, 0.05, 0.4);
      c.yields = k == bodies ? test::uniform(random, 0.01, 0.1) : 0.0;
      for (int r = 0; r < 3; ++r) {
        for (int i = 0; i < IslandNewton::kSize; ++i) {
          if (k > 0) c.along_a[r][i] = test::uniform(random, -2.0, 2.0);
          c.along_b[r][i] = test::uniform(random, -2.0, 2.0);
        }
      }
      c.goal = {test::uniform(random, -0.005, 0.02), test::uniform(random, -0.01, 0.01),
                test::uniform(random, -0.01, 0.01)};
      c.start = {0.0, 0.0, 0.0};
      goals.push_back(c.goal);
    }
  }
  return goals;
}

/// Signorini's and Coulomb's laws with the softness of each normal, for the impulses and velocities
/// that were found: the largest miss of a velocity or, times the mobility, of an impulse.
double missOf(const IslandNewton& newton, const std::vector<std::array<double, 3>>& goals) {
  double worst = 0.0;
  for (int i = 0; i < newton.contactCount(); ++i) {
    const IslandNewton::Contact& c = newton.contact(i);
    std::array<double, 3> v{};
    for (int r = 0; r < 3; ++r) {
      for (int k = 0; k < IslandNewton::kSize; ++k) {
        v[r] += c.along_b[r][k] * newton.change(c.b)[k];
        if (c.a >= 0) v[r] += c.along_a[r][k] * newton.change(c.a)[k];
      }
      v[r] -= goals[i][r];
    }
    const double gap = v[0] + c.gives * c.impulse[0];
    worst = std::max(worst, c.impulse[0] > 0.0 ? std::abs(gap) : -gap);
    const double slip = std::hypot(v[1], v[2]), rubs = std::hypot(c.impulse[1], c.impulse[2]);
    const double limit = c.friction * c.impulse[0];
    worst = std::max(worst, rubs - limit);
    // Below the limit it sticks; at the limit it opposes the slip.
    if (rubs < limit * (1.0 - 1e-6)) {
      worst = std::max(worst, slip);
    } else if (limit > 0.0) {
      worst = std::max(
          worst, std::hypot(v[1] + slip * c.impulse[1] / rubs, v[2] + slip * c.impulse[2] / rubs));
    }
  }
  return worst;
}

// Where friction is given limits by the last impulses, the miss is 10⁻⁶ of the wanted velocities.
TEST(IslandNewton, IslandWithTheHand_ObeysTheLawOfFrictionExactly) {
  auto random = test::seededRandom(6104);
  static IslandNewton newton;
  const int draws = 200;
  int exact = 0, exact_with_limits = 0;
  for (int i = 0; i < draws; ++i) {
    const int bodies = 1 + static_cast<int>(random() % 4);
    const auto state = random;
    for (const bool coupled : {false, true}) {
      random = state;
      const auto goals = grasp(newton, bodies, random);
      ASSERT_GT(newton.order(), 0);
      ASSERT_TRUE(newton.solve(40, coupled ? 120 : 0));
      if (missOf(newton, goals) <= 1e-9) ++(coupled ? exact : exact_with_limits);
      // The softness that stays is 3 · 10⁻⁶ of the largest goal over the largest impulse that
      // one normal alone would need for it, or over a larger one: at most of a normal's mobility.
      double mobility = 0.0;
      for (int k = 0; k < newton.contactCount(); ++k) {
        if (!newton.contact(k).of_joint)
          mobility = std::max(mobility, newton.contact(k).mobility[0]);
      }
      for (int k = 0; k < newton.contactCount(); ++k) {
        const IslandNewton::Contact& c = newton.contact(k);
        if (c.yields > 0.0) continue;
        EXPECT_LE(c.gives, 3e-6 * (1.0 + 1e-12) * mobility);
      }
    }
  }
  std::printf("figure: exact %d of %d, with given limits %d\n", exact, draws, exact_with_limits);
  EXPECT_GE(exact, draws * 9 / 10);
  EXPECT_LE(exact_with_limits, draws / 2);
}

}  // namespace
}  // namespace wholehand::bullet
