// Constraint rows between bodies, four at once. Without friction they move bodies as Bullet's own
// rows do.
#include "loop/physics/bullet/body_rows.hpp"

#include "loop/core/compiler.hpp"
#include "loop/physics/bullet/row_arithmetic.hpp"
#include "support/seed.hpp"

#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace wholehand::bullet {
namespace {

constexpr int kBodies = 30, kContacts = 120;
constexpr double kStep_s = 1e-3;
// The speed limit of contacts is off (1e9): Bullet has none.
const ContactGoals kGoals{kStep_s, 1e-5, 0.05, 1e9, 0.97, 0.2};

btVector3 vector(std::mt19937_64& random) {
  std::normal_distribution<double> number;
  const double x = number(random), y = number(random), z = number(random);
  return {x, y, z};
}

/// Bullet's own constraint rows for the same contacts.
class Bullet final : public btSequentialImpulseConstraintSolver {
 public:
  Bullet() {
    info_.m_timeStep = kStep_s;
    info_.m_splitImpulse = 0;
    info_.m_erp2 = kGoals.erp;
    info_.m_linearSlop = kGoals.slop_m;
    info_.m_warmstartingFactor = kGoals.warm_start;
    info_.m_restitutionVelocityThreshold = kGoals.bounce_from_m_s;
    info_.m_solverMode |=
        SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  }

  void begin() {
    m_tmpSolverBodyPool.resizeNoInitialize(0);
    m_tmpSolverContactConstraintPool.resizeNoInitialize(0);
    m_tmpSolverContactFrictionConstraintPool.resizeNoInitialize(0);
    m_fixedBodyId = -1;
  }
  int bodyOf(btRigidBody& rigid) { return getOrInitSolverBody(rigid, kStep_s); }
  void add(btPersistentManifold& manifold) { convertContact(&manifold, info_); }
  btAlignedObjectArray<btSolverBody>& bodies() { return m_tmpSolverBodyPool; }

  // As Bullet's solveSingleIteration(); every second sweep runs from the last row to the first.
  void sweep(const std::vector<bool>& touched, bool near_only, bool backwards) {
    const auto press = getActiveConstraintRowSolverLowerLimit();
    btConstraintArray& normals = m_tmpSolverContactConstraintPool;
    for (int k = 0; k < normals.size(); ++k) {
      btSolverConstraint& row = normals[backwards ? normals.size() - 1 - k : k];
      const bool near = touched[row.m_solverBodyIdA] || touched[row.m_solverBodyIdB];
      if (near || !near_only)
        press(bodies()[row.m_solverBodyIdA], bodies()[row.m_solverBodyIdB], row);
    }
  }
  [[nodiscard]] double impulse(int contact) const {
    return m_tmpSolverContactConstraintPool[contact].m_appliedImpulse;
  }

 private:
  btContactSolverInfo info_;
};

/// Random contacts among bodies of random position, motion, mass and inertia; the first body is
/// fixed.
struct Contacts {
  btEmptyShape shape;
  std::vector<std::unique_ptr<btRigidBody>> rigids;
  std::vector<btPersistentManifold> manifolds;

  explicit Contacts(std::mt19937_64& random, double friction = 0.0) {
    std::uniform_real_distribution<double> positive(0.1, 2.0);
    for (int i = 0; i < kBodies; ++i) {
      const btVector3 inertia(positive(random), positive(random), positive(random));
      btRigidBody::btRigidBodyConstructionInfo of(i == 0 ? 0.0 : positive(random), nullptr, &shape,
                                                  inertia);
      of.m_startWorldTransform.setOrigin(vector(random));
      of.m_startWorldTransform.setRotation(
          btQuaternion(vector(random).normalized(), positive(random)));
      auto& rigid = *rigids.emplace_back(std::make_unique<btRigidBody>(of));
      rigid.setCompanionId(-1);
      if (i == 0) continue;
      rigid.setLinearVelocity(vector(random));
      rigid.setAngularVelocity(vector(random));
      rigid.applyCentralForce(btVector3(0, 0, -9.81) / rigid.getInvMass());
    }
    std::uniform_int_distribution<int> body(0, kBodies - 1);
    manifolds.reserve(kContacts);
    for (int i = 0; i < kContacts; ++i) {
      const int a = body(random), b = (a + 1 + body(random) % (kBodies - 1)) % kBodies;
      auto& manifold = manifolds.emplace_back(rigids[a].get(), rigids[b].get(), 0, 1.0, 1.0);
      btManifoldPoint point;
      point.m_normalWorldOnB = vector(random).normalized();
      point.m_distance1 = 2e-4 * vector(random).x();
      point.m_positionWorldOnA = vector(random);
      point.m_positionWorldOnB =
          point.m_positionWorldOnA - point.m_normalWorldOnB * point.m_distance1;
      point.m_combinedFriction = friction;
      point.m_combinedRestitution = i % 4 == 0 ? 0.5 : 0.0;
      manifold.addManifoldPoint(point);
      manifold.getContactPoint(0).m_appliedImpulse = i % 3 == 0 ? positive(random) : 0.0;
    }
  }
};

void expectNear(const btVector3& a, const btVector3& b) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], 1e-10);
}

TEST(BodyRows, SweptBetweenPushesOfTheHand_MoveBodiesAsBulletsRowsDo) {
  auto random = test::seededRandom(6702);
  BodyRows rows(kContacts, kBodies);
  for (int round = 0; round < 20; ++round) {
    auto same = random;
    Contacts our_contacts(random), their_contacts(same);
    Bullet ours, bullets;
    ours.begin(), bullets.begin();
    std::vector<bool> touched(kBodies + 1);
    rows.clear();
    EXPECT_EQ(rows.room(), kContacts);
    for (int i = 1; i < kBodies; ++i) {
      const int id = ours.bodyOf(*our_contacts.rigids[i]);
      ASSERT_EQ(bullets.bodyOf(*their_contacts.rigids[i]), id);
      touched[id] = i % 9 == 0;
    }
    for (int i = 0; i < kContacts; ++i) {
      btPersistentManifold& manifold = our_contacts.manifolds[i];
      const auto id = [&](const btCollisionObject* of) {
        return ours.bodyOf(*const_cast<btRigidBody*>(static_cast<const btRigidBody*>(of)));
      };
      rows.add(manifold, id(manifold.getBody0()), id(manifold.getBody1()), kGoals, ours.bodies(),
               touched);
      bullets.add(their_contacts.manifolds[i]);
    }
    EXPECT_EQ(rows.room(), 0);
    rows.begin(ours.bodies(), touched);
    ASSERT_TRUE(rows.any() && rows.anyNear());
    for (int sweep = 0; sweep < 12; ++sweep) {
      const bool near_only = sweep >= 6;
      const double most = near_only ? rows.sweepNear(ours.bodies()) : rows.sweepAll(ours.bodies());
      EXPECT_GT(most, 0.0);
      bullets.sweep(touched, near_only, sweep % 2 == 1);
      // Changes velocities as the hand's rows do between two sweeps.
      for (int i = 0; i < ours.bodies().size(); ++i) {
        if (!touched[i]) continue;
        const btVector3 push = 0.1 * vector(random);
        ours.bodies()[i].m_deltaLinearVelocity += push;
        bullets.bodies()[i].m_deltaLinearVelocity += push;
      }
    }
    rows.write(ours.bodies());
    int pressing = 0;
    for (int i = 0; i < kContacts; ++i) {
      const btManifoldPoint& point = our_contacts.manifolds[i].getContactPoint(0);
      EXPECT_NEAR(point.m_appliedImpulse, bullets.impulse(i), 1e-10);
      EXPECT_EQ(point.m_appliedImpulseLateral1, 0.0);
      EXPECT_EQ(point.m_appliedImpulseLateral2, 0.0);
      pressing += point.m_appliedImpulse > 0.0 ? 1 : 0;
    }
    for (int i = 0; i < ours.bodies().size(); ++i) {
      expectNear(ours.bodies()[i].m_deltaLinearVelocity, bullets.bodies()[i].m_deltaLinearVelocity);
      expectNear(ours.bodies()[i].m_deltaAngularVelocity,
                 bullets.bodies()[i].m_deltaAngularVelocity);
    }
    EXPECT_GT(pressing, kContacts / 10);
    EXPECT_LT(pressing, kContacts);
    if (testing::Test::HasFailure()) return;
  }
}

/// Two bodies that stick: their contact points end without relative velocity for any initial
/// velocity, and the momentum that one gains the other loses.
TEST(BodyRows, ContactThatSticks_EndsTheSlipAndKeepsMomentum) {
  auto random = test::seededRandom(6703);
  BodyRows rows(1, 3);
  int stuck = 0;
  for (int round = 0; round < 200; ++round) {
    Contacts contacts(random, 1e9);
    btPersistentManifold& manifold = contacts.manifolds[0];
    btManifoldPoint& point = manifold.getContactPoint(0);
    point.m_distance1 = 0.0;
    point.m_combinedRestitution = 0.0;
    point.m_positionWorldOnB = point.m_positionWorldOnA;
    point.m_appliedImpulse = 1.0;
    point.m_appliedImpulseLateral1 = vector(random).x();
    point.m_appliedImpulseLateral2 = vector(random).x();
    Bullet solver;
    solver.begin();
    std::vector<bool> touched(3);
    std::array<btRigidBody*, 2> rigids{};
    std::array<int, 2> ids{};
    for (int i = 0; i < 2; ++i) {
      const btCollisionObject* of = i == 0 ? manifold.getBody0() : manifold.getBody1();
      rigids[i] = const_cast<btRigidBody*>(static_cast<const btRigidBody*>(of));
      ids[i] = solver.bodyOf(*rigids[i]);
    }
    rows.clear();
    rows.add(manifold, ids[0], ids[1], kGoals, solver.bodies(), touched);
    rows.begin(solver.bodies(), touched);
    double change = 1.0;
    for (int sweep = 0; sweep < 20'000 && change > 1e-14; ++sweep) {
      change = rows.sweepAll(solver.bodies());
    }
    rows.write(solver.bodies());
    std::array<btVector3, 2> velocity, gained;
    for (int i = 0; i < 2; ++i) {
      const btSolverBody& body = solver.bodies()[ids[i]];
      velocity[i].setZero(), gained[i].setZero();
      if (body.m_originalBody == nullptr) continue;
      const btVector3 arm = point.m_positionWorldOnA - rigids[i]->getCenterOfMassPosition();
      velocity[i] = body.m_linearVelocity + body.m_externalForceImpulse +
                    body.m_deltaLinearVelocity +
                    (body.m_angularVelocity + body.m_deltaAngularVelocity).cross(arm);
      gained[i] = body.m_deltaLinearVelocity / rigids[i]->getInvMass();
    }
    const btVector3 impulse = point.m_appliedImpulse * point.m_normalWorldOnB +
                              point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                              point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
    for (int i = 0; i < 2; ++i) {
      if (rigids[i]->getInvMass() > 0.0) {
        EXPECT_LE((gained[i] - (i == 0 ? 1.0 : -1.0) * impulse).length(), 1e-9);
      }
    }
    // Skips contacts that separate or that the cone limits: friction of any size needs a normal
    // impulse.
    if (point.m_appliedImpulse <= 0.0 || change > 1e-14) continue;
    ++stuck;
    // Bodies that are apart by the slop may close that distance.
    const btVector3 slip = velocity[0] - velocity[1];
    EXPECT_LE((slip + point.m_normalWorldOnB * (kGoals.slop_m / kStep_s)).length(), 1e-6);
  }
  EXPECT_GT(stuck, 50);
}

TEST(BodyRows, NoContacts_HaveNothingToSweep) {
  BodyRows rows(kContacts, kBodies);
  BodyRows::Bodies bodies;
  rows.clear();
  rows.begin(bodies, {});
  EXPECT_FALSE(rows.any() || rows.anyNear());
  EXPECT_EQ(rows.sweepAll(bodies), 0.0);
}

// ---- arithmetic of solver rows: the sums as defined, and the same bits on every processor

constexpr int kAxes = 8;

/// A row and the velocities it acts on; random numbers of many magnitudes.
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

TEST(RowArithmetic, ScaledRow_IsAddedElementByElement) {
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
