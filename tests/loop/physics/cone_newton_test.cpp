// Contacts solved together: closed forms, and the contact conditions of the impulses, computed from
// their definition by separate code.
#include "loop/physics/bullet/cone_newton.hpp"

#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace wholehand::bullet {
namespace {

using Rows = ConeNewton::Row*;

double velocityAlong(const ConeNewton::Row& row, const ConeNewton& solver) {
  double sum = 0.0;
  for (std::size_t u = 0; u < ConeNewton::kMostUnknowns; ++u) {
    sum += row.along[u] * solver.change()[u];
  }
  return sum;
}

/// y of a row, by its definition.
double freeImpulse(const ConeNewton::Row& row, const ConeNewton& solver) {
  return row.start + (row.goal - velocityAlong(row, solver)) * row.inverse_softness;
}

TEST(ConeNewton, OneNormalRow_MatchesTheClosedForm) {
  // x = x₀ + (goal − a x) / R with a = |j|² = 4 and R = softness a: x = (goal + R x₀) / (a + R).
  NewtonSettings settings;
  settings.end_softness = 0.5;
  const auto solver = std::make_unique<ConeNewton>(settings);
  solver->begin(6);
  const Rows row = solver->add(1, 0.0, 0.0);
  ASSERT_NE(row, nullptr);
  row->along[2] = 2.0;
  row->goal = 0.3;
  row->start = 0.01;
  ASSERT_TRUE(solver->solve());
  EXPECT_NEAR(solver->row(0).impulse, (0.3 + 2.0 * 0.01) / (4.0 + 2.0), 1e-15);
  EXPECT_NEAR(solver->change()[2], 2.0 * solver->row(0).impulse, 1e-15);
}

TEST(ConeNewton, SeparatingContact_HasNoImpulse) {
  const auto solver = std::make_unique<ConeNewton>(NewtonSettings{});
  solver->begin(6);
  const Rows rows = solver->add(4, 0.8, 0.002);
  ASSERT_NE(rows, nullptr);
  for (int i = 0; i < 4; ++i) rows[i].along[static_cast<std::size_t>(i)] = 1.0;
  rows[0].goal = -0.1;
  rows[1].goal = 0.2;
  ASSERT_TRUE(solver->solve());
  for (int i = 0; i < 4; ++i) EXPECT_EQ(solver->row(i).impulse, 0.0);
}

TEST(ConeNewton, BlockPushedBeyondItsFriction_SlidesAtTheLimit) {
  // Rows along three axes are independent: the normal impulse is goal / (1 + R), and friction is μ
  // times that along the goal's direction, (3, 4) / 5.
  const auto solver = std::make_unique<ConeNewton>(NewtonSettings{});
  solver->begin(6);
  const Rows rows = solver->add(3, 0.5, 0.0);
  ASSERT_NE(rows, nullptr);
  for (int i = 0; i < 3; ++i) rows[i].along[static_cast<std::size_t>(i)] = 1.0;
  rows[0].goal = 1.0;
  rows[1].goal = 3.0;
  rows[2].goal = 4.0;
  ASSERT_TRUE(solver->solve());
  const double normal = 1.0 / (1.0 + NewtonSettings{}.softness);
  EXPECT_NEAR(solver->row(0).impulse, normal, 1e-12);
  EXPECT_NEAR(solver->row(1).impulse, 0.5 * normal * 0.6, 1e-4);
  EXPECT_NEAR(solver->row(2).impulse, 0.5 * normal * 0.8, 1e-4);
}

TEST(ConeNewton, NoRoomForARow_IsReported) {
  const auto solver = std::make_unique<ConeNewton>(NewtonSettings{});
  solver->begin(6);
  int added = 0;
  while (solver->add(4, 0.5, 0.0) != nullptr) ++added;
  EXPECT_EQ(added, ConeNewton::kMostRows / 4);
}

/// A body of unit inertia in a hand of six axes that touches it at random points.
void fillGrasp(ConeNewton& solver, int contacts, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> share(0.0, 1.0);
  solver.begin(12);
  for (int c = 0; c < contacts; ++c) {
    const Rows rows = solver.add(4, 0.8, 0.002);
    std::array<double, 3> towards{normal(random), normal(random), normal(random)};
    const double length = std::hypot(towards[0], towards[1], towards[2]);
    for (double& n : towards) n /= length;
    const std::size_t finger = static_cast<std::size_t>(c % 4) + 2;
    for (int i = 0; i < 4; ++i) {
      for (std::size_t a = 0; a < 2; ++a) rows[i].along[a] = normal(random);
      rows[i].along[finger] = 3.0 * normal(random);
    }
    rows[0].along[finger] = 6.0;  // a finger presses along the normal
    for (std::size_t a = 0; a < 3; ++a) rows[0].along[6 + a] = -3.0 * towards[a];
    const std::size_t least = std::abs(towards[0]) < 0.5 ? 0 : 1;
    rows[1].along[6 + least] = 3.0;
    rows[2].along[6 + (least + 1) % 3] = 3.0;
    for (std::size_t a = 9; a < 12; ++a) rows[1].along[a] = normal(random);
    for (std::size_t a = 0; a < 3; ++a) rows[3].along[9 + a] = -40.0 * towards[a];
    rows[0].goal = 0.2 * share(random);
    for (int i = 1; i < 4; ++i) rows[i].goal = 0.02 * normal(random);
    rows[0].start = 5e-3 * share(random);
  }
}

/// Largest difference between the y of a row and the y that the solver projected. Every impulse
/// differs from its linear piece by at most the tolerance, and y = x₀ + (goal − j·Σ j_k x_k) / R.
double mostOff(const ConeNewton& solver, int of, int rows, double tolerance) {
  const ConeNewton::Row& row = solver.row(of);
  double sum = 0.0;
  for (int k = 0; k < rows; ++k) {
    sum += std::abs(
        std::inner_product(row.along.begin(), row.along.end(), solver.row(k).along.begin(), 0.0));
  }
  return tolerance * (1.0 + sum * row.inverse_softness);
}

TEST(ConeNewton, RandomGrasps_SatisfyTheContactConditions) {
  auto random = test::seededRandom(5501);
  int solved = 0;
  constexpr int kGrasps = 2000;
  const auto solver = std::make_unique<ConeNewton>(NewtonSettings{});
  for (int k = 0; k < kGrasps; ++k) {
    const int contacts = 1 + k % 6;
    fillGrasp(*solver, contacts, random);
    if (!solver->solve()) continue;  // sweeps are used instead
    ++solved;
    double pressed = 0.0;
    for (int c = 0; c < contacts; ++c) pressed += solver->row(4 * c).impulse;
    const double tolerance = NewtonSettings{}.tolerance * pressed + 1e-9;
    for (int c = 0; c < contacts; ++c) {
      const auto row = [&](int i) -> const ConeNewton::Row& { return solver->row(4 * c + i); };
      const auto most = [&](int i) { return mostOff(*solver, 4 * c + i, 4 * contacts, tolerance); };
      const double n = row(0).impulse;
      ASSERT_NEAR(n, std::max(0.0, freeImpulse(row(0), *solver)), most(0)) << "grasp " << k;
      const double y1 = freeImpulse(row(1), *solver), y2 = freeImpulse(row(2), *solver);
      const double cut = std::min(1.0, 0.8 * n / std::max(1e-300, std::hypot(y1, y2)));
      ASSERT_NEAR(row(1).impulse, cut * y1, most(1) + most(2)) << "grasp " << k;
      ASSERT_NEAR(row(2).impulse, cut * y2, most(1) + most(2)) << "grasp " << k;
      ASSERT_LE(std::hypot(row(1).impulse, row(2).impulse), 0.8 * n * (1.0 + 1e-12));
      ASSERT_LE(std::abs(row(3).impulse), 0.002 * n * (1.0 + 1e-12));
    }
  }
  EXPECT_GT(solved, kGrasps / 3);
}

}  // namespace
}  // namespace wholehand::bullet
