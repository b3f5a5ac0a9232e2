// Rows between bodies, four at once. Without friction: the bits of Bullet's own sweep, row by row.
#include "physics/bullet/body_rows.hpp"

#include "core/vector_clones.hpp"
#include "physics/bullet/row_arithmetic.hpp"
#include "support/seed.hpp"

#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace wholehand::bullet {
namespace {

constexpr int kBodies = 30, kContacts = 120;

/// Random contacts among bodies, the first of which is fixed, as Bullet's solver sets them up.
struct Contacts {
  BodyRows::Bodies bodies;
  btConstraintArray normals, frictions;
  std::vector<bool> touched;
  std::vector<btManifoldPoint> points;

  Contacts(std::mt19937_64& random, btRigidBody& any) : touched(kBodies), points(kContacts) {
    std::uniform_real_distribution<double> positive(0.1, 2.0);
    std::uniform_int_distribution<int> body(0, kBodies - 1);
    for (int i = 0; i < kBodies; ++i) {
      btSolverBody& added = bodies.expand(btSolverBody{});
      const bool moves = i > 0;
      added.m_originalBody = moves ? &any : nullptr;
      added.m_invMass = moves ? btVector3(1, 1, 1) * positive(random) : btVector3(0, 0, 0);
      added.m_linearFactor = added.m_angularFactor = btVector3(1, 1, 1);
      added.m_deltaLinearVelocity = moves ? vector(random) : btVector3(0, 0, 0);
      added.m_deltaAngularVelocity = moves ? vector(random) : btVector3(0, 0, 0);
      touched[i] = moves && i % 9 == 0;
    }
    for (int i = 0; i < kContacts; ++i) {
      const int a = body(random), b = (a + 1 + body(random) % (kBodies - 1)) % kBodies;
      btSolverConstraint& normal = add(normals, a, b, random);
      normal.m_appliedImpulse = i % 3 == 0 ? positive(random) : 0.0;
      normal.m_frictionIndex = frictions.size();
      for (int k = 0; k < 2; ++k) {
        btSolverConstraint& tangent = add(frictions, a, b, random);
        tangent.m_friction = 0.0;  // Bullet's is a square, ours a disc: friction_disc_test.cpp
        tangent.m_relpos1CrossNormal = tangent.m_relpos2CrossNormal = btVector3(0, 0, 0);
        tangent.m_angularComponentA = tangent.m_angularComponentB = btVector3(0, 0, 0);
      }
    }
  }

  static btVector3 vector(std::mt19937_64& random) {
    std::normal_distribution<double> number;
    const double x = number(random), y = number(random), z = number(random);
    return {x, y, z};
  }

  btSolverConstraint& add(btConstraintArray& rows, int a, int b, std::mt19937_64& random) const {
    std::uniform_real_distribution<double> positive(0.1, 2.0);
    btSolverConstraint& row = rows.expand(btSolverConstraint{});
    const btVector3 along = vector(random).normalized(), none(0, 0, 0);
    const bool a_moves = a > 0, b_moves = b > 0;
    row.m_solverBodyIdA = a;
    row.m_solverBodyIdB = b;
    row.m_contactNormal1 = a_moves ? along : none;
    row.m_contactNormal2 = b_moves ? -along : none;
    row.m_relpos1CrossNormal = a_moves ? vector(random) : none;
    row.m_relpos2CrossNormal = b_moves ? vector(random) : none;
    row.m_angularComponentA = a_moves ? row.m_relpos1CrossNormal * positive(random) : none;
    row.m_angularComponentB = b_moves ? row.m_relpos2CrossNormal * positive(random) : none;
    row.m_jacDiagABInv = 0.1 * positive(random);
    row.m_rhs = 0.3 * vector(random).x();
    row.m_cfm = 0.0;
    row.m_appliedImpulse = 0.0;
    row.m_lowerLimit = 0.0;
    row.m_upperLimit = 1e10;
    return row;
  }

  // One manifold after the other.
  void addTo(BodyRows& rows) {
    for (int i = 0; i < kContacts; ++i) {
      btConstraintArray one, its_frictions;
      one.push_back(normals[i]);
      one[0].m_frictionIndex = 0;
      one[0].m_originalContactPoint = &points[i];
      for (int k = 0; k < 2; ++k) its_frictions.push_back(frictions[2 * i + k]);
      rows.add(one, its_frictions, bodies, touched);
    }
  }

  // As the hand's rows do between two sweeps.
  void push(std::mt19937_64& random) {
    for (int i = 0; i < kBodies; ++i) {
      if (touched[i]) bodies[i].m_deltaLinearVelocity += 0.1 * vector(random);
    }
  }

  // As Bullet's solveSingleIteration(); every second time from the last to the first.
  void sweep(btSequentialImpulseConstraintSolver& solver, bool near_only, bool backwards) {
    const auto press = solver.getActiveConstraintRowSolverLowerLimit();
    const auto left_out = [&](const btSolverConstraint& row) {
      return near_only && !touched[row.m_solverBodyIdA] && !touched[row.m_solverBodyIdB];
    };
    for (int k = 0; k < normals.size(); ++k) {
      btSolverConstraint& row = normals[backwards ? normals.size() - 1 - k : k];
      if (!left_out(row)) press(bodies[row.m_solverBodyIdA], bodies[row.m_solverBodyIdB], row);
    }
  }
};

void expectSame(const btVector3& a, const btVector3& b) {
  for (int k = 0; k < 3; ++k) EXPECT_EQ(a[k], b[k]);
}

TEST(BodyRows, SweptBetweenPushesOfTheHand_HaveTheBitsOfBulletsOwnSweep) {
  auto random = test::seededRandom(6702);
  btSequentialImpulseConstraintSolver solver;
  btEmptyShape shape;
  btRigidBody any(btRigidBody::btRigidBodyConstructionInfo(1.0, nullptr, &shape));
  BodyRows rows(kContacts, kBodies);
  for (int round = 0; round < 20; ++round) {
    auto same = random;
    Contacts ours(random, any), bullets(same, any);
    rows.clear();
    EXPECT_EQ(rows.room(), kContacts);
    ours.addTo(rows);
    EXPECT_EQ(rows.room(), 0);
    rows.begin(ours.bodies, ours.touched);
    ASSERT_TRUE(rows.any() && rows.anyNear());
    for (int sweep = 0; sweep < 12; ++sweep) {
      const bool near_only = sweep >= 6;
      const double most = near_only ? rows.sweepNear(ours.bodies) : rows.sweepAll(ours.bodies);
      EXPECT_GT(most, 0.0);
      bullets.sweep(solver, near_only, sweep % 2 == 1);
      ours.push(random);
      bullets.push(same);
    }
    rows.write(ours.bodies);
    int pressing = 0;
    for (int i = 0; i < kContacts; ++i) {
      const btManifoldPoint& point = ours.points[i];
      EXPECT_EQ(point.m_appliedImpulse, bullets.normals[i].m_appliedImpulse);
      EXPECT_EQ(point.m_appliedImpulseLateral1, 0.0);
      EXPECT_EQ(point.m_appliedImpulseLateral2, 0.0);
      pressing += point.m_appliedImpulse > 0.0 ? 1 : 0;
    }
    for (int i = 0; i < kBodies; ++i) {
      expectSame(ours.bodies[i].m_deltaLinearVelocity, bullets.bodies[i].m_deltaLinearVelocity);
      expectSame(ours.bodies[i].m_deltaAngularVelocity, bullets.bodies[i].m_deltaAngularVelocity);
    }
    EXPECT_GT(pressing, kContacts / 10);
    EXPECT_LT(pressing, kContacts);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(BodyRows, WithoutContacts_HaveNothingToSweep) {
  BodyRows rows(kContacts, kBodies);
  BodyRows::Bodies bodies;
  rows.clear();
  rows.begin(bodies, {});
  EXPECT_FALSE(rows.any() || rows.anyNear());
  EXPECT_EQ(rows.sweepAll(bodies), 0.0);
}

// Arithmetic of solver rows: the sums as they are defined, and the same bits on every processor.

constexpr int kAxes = 8;

/// A row, and what it moves; random numbers of many sizes.
struct Numbers {
  std::array<double, kAxes> jacobian{}, change{};
  std::array<double, 4> linear{}, linear_velocity{}, angular{}, angular_velocity{};

  explicit Numbers(std::mt19937_64& random) {
    std::normal_distribution<double> mantissa;
    std::uniform_int_distribution<int> exponent(-20, 20);
    const auto fill = [&](auto& numbers) {
      for (double& n : numbers) n = std::ldexp(mantissa(random), exponent(random));
    };
    fill(jacobian), fill(change);
    fill(linear), fill(linear_velocity), fill(angular), fill(angular_velocity);
  }
};

// The definition, one product at a time in the order that the header states.
double byDefinition(const Numbers& n) {
  std::array<double, 4> sum{};
  for (std::size_t i = 0; i < 4; ++i) {
    const volatile double along = n.linear[i] * n.linear_velocity[i];  // volatile: never fused
    const volatile double about = n.angular[i] * n.angular_velocity[i];
    sum[i] = along + about;
  }
  for (std::size_t a = 0; a < kAxes; ++a) {
    const volatile double product = n.jacobian[a] * n.change[a];
    sum[a % 4] += product;
  }
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

// As the solver calls it: compiled for AVX and for any processor.
WHOLEHAND_VECTOR_CLONES double onThisProcessor(const Numbers& n) {
  return alongRow<kAxes>(n.jacobian.data(), n.change.data(), n.linear.data(),
                         n.linear_velocity.data(), n.angular.data(), n.angular_velocity.data());
}

double onAnyProcessor(const Numbers& n) {
  return alongRow<kAxes>(n.jacobian.data(), n.change.data(), n.linear.data(),
                         n.linear_velocity.data(), n.angular.data(), n.angular_velocity.data());
}

WHOLEHAND_VECTOR_CLONES void addOnThisProcessor(Numbers& n, double factor) {
  addScaled<kAxes>(n.change.data(), factor, n.jacobian.data());
}

void addOnAnyProcessor(Numbers& n, double factor) {
  addScaled<kAxes>(n.change.data(), factor, n.jacobian.data());
}

TEST(RowArithmetic, EveryProcessor_GivesTheBitsOfTheDefinition) {
  auto random = test::seededRandom(1203);
  for (int i = 0; i < 10'000; ++i) {
    const Numbers n(random);
    const double expected = byDefinition(n);
    ASSERT_EQ(onThisProcessor(n), expected) << "numbers " << i;
    ASSERT_EQ(onAnyProcessor(n), expected) << "numbers " << i;
  }
}

TEST(RowArithmetic, AScaledRow_IsAddedNumberByNumber) {
  auto random = test::seededRandom(1204);
  for (int i = 0; i < 10'000; ++i) {
    const Numbers before(random);
    Numbers here = before, anywhere = before;
    const double factor = before.linear[0];
    addOnThisProcessor(here, factor);
    addOnAnyProcessor(anywhere, factor);
    for (std::size_t a = 0; a < kAxes; ++a) {
      const volatile double product = factor * before.jacobian[a];
      ASSERT_EQ(here.change[a], before.change[a] + product) << "numbers " << i;
      ASSERT_EQ(anywhere.change[a], here.change[a]) << "numbers " << i;
    }
  }
}

}  // namespace
}  // namespace wholehand::bullet
