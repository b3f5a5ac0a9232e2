// Resting bodies cost nothing, and they react fully when something touches them.
#include "loop/physics/engine_bench.hpp"
#include "support/tolerance.hpp"

#include <cstring>

namespace wholehand::test {
namespace {

/// The hand stays here, away from all bodies.
AxisPosition aside() {
  AxisPosition q(6);
  q[0] = -0.08, q[2] = 0.11;
  return q;
}

SceneBody block(const Eigen::Vector3d& center_m, double edge_m, double mass_kg) {
  SceneBody body = fixedBox(center_m, Eigen::Vector3d::Constant(edge_m));
  body.fixed = false;
  body.mass_kg = mass_kg;
  body.inertia_kg_m2 = mass_kg * edge_m * edge_m / 6.0 * Eigen::Matrix3d::Identity();
  return body;
}

SceneModel onEarth(std::vector<SceneBody> bodies) {
  SceneModel scene = weightless(std::move(bodies));
  scene.gravity_m_s2 = {0.0, 0.0, -kGravity_m_s2};
  return scene;
}

void run(Bench& bench, int steps) {
  for (int k = 0; k < steps; ++k) ASSERT_NO_FATAL_FAILURE(bench.step(aside(), AxisVelocity(6)));
}

/// Places a body with a velocity.
void put(Bench& bench, int body, const Eigen::Vector3d& at_m, const Eigen::Vector3d& velocity) {
  BodyPlacements placements;
  placements.count = 1;
  placements.items[0].body = body;
  placements.items[0].position_m = Vec3::from(at_m);
  placements.items[0].velocity_m_s = Vec3::from(velocity);
  bench.world->placeBodies(placements);
}

TEST(RestingBodies, StandingFromTheStart_StaysToTheBit) {
  Bench bench(defaultEngine(),
              onEarth({fixedBox({0.6, 0.0, -0.01}, {0.5, 0.5, 0.02}),
                       block({0.6, 0.0, 0.02}, 0.04, 0.1), block({0.6, 0.0, 0.06}, 0.04, 0.1)}));
  ASSERT_TRUE(bench.world->placeHand(aside()));
  const PhysicsState before = look(*bench.world);
  ASSERT_NO_FATAL_FAILURE(run(bench, 300));
  for (int i = 0; i < before.body_count; ++i) {
    EXPECT_EQ(0, std::memcmp(&before.bodies[i], &bench.after.bodies[i], sizeof(BodyState))) << i;
  }
}

TEST(RestingBodies, FallingOntoATable_ComesToRest) {
  Bench bench(defaultEngine(), onEarth({fixedBox({0.6, 0.0, -0.01}, {0.5, 0.5, 0.02}),
                                        block({0.6, 0.0, 0.03}, 0.04, 0.1)}));
  ASSERT_TRUE(bench.world->placeHand(aside()));
  ASSERT_NO_FATAL_FAILURE(run(bench, 20));
  // √(2 · 9.81 · 0.01) = 0.44 m/s after 45 ms: after 20 ms it falls with g t.
  EXPECT_NEAR(bench.after.bodies[1].velocity_m_s.z, -kGravity_m_s2 * 0.02, tolerance(1e-3));
  ASSERT_NO_FATAL_FAILURE(run(bench, 1500));
  EXPECT_EQ(bench.after.bodies[1].velocity_m_s.eigen().norm(), 0.0);
  EXPECT_NEAR(bench.after.bodies[1].position_m.z, 0.02, tolerance(5e-5));
}

TEST(RestingBodies, TableTakenAway_MakesThemFall) {
  Bench bench(defaultEngine(),
              onEarth({fixedBox({0.6, 0.0, -0.01}, {0.2, 0.2, 0.02}),
                       block({0.6, 0.0, 0.02}, 0.04, 0.1), block({0.6, 0.0, 0.06}, 0.04, 0.1)}));
  ASSERT_TRUE(bench.world->placeHand(aside()));
  ASSERT_NO_FATAL_FAILURE(run(bench, 100));
  put(bench, 0, {0.6, 1.0, -0.01}, Eigen::Vector3d::Zero());
  ASSERT_NO_FATAL_FAILURE(run(bench, 100));
  for (const int body : {1, 2}) {  // both fall freely: g t
    EXPECT_NEAR(bench.after.bodies[body].velocity_m_s.z, -kGravity_m_s2 * 0.1,
                tolerance(0.01) * kGravity_m_s2 * 0.1)
        << body;
  }
}

TEST(RestingBodies, HitByAnotherBody_ReceiveAllOfItsMomentum) {
  Bench bench(defaultEngine(),
              weightless({ball({0.6, 0.0, 0.0}, 0.02, 0.1), ball({0.7, 0.0, 0.0}, 0.02, 0.1)}));
  ASSERT_TRUE(bench.world->placeHand(aside()));
  ASSERT_NO_FATAL_FAILURE(run(bench, 50));
  put(bench, 0, {0.6, 0.0, 0.0}, {0.5, 0.0, 0.0});
  ASSERT_NO_FATAL_FAILURE(run(bench, 400));
  const double first_m_s = bench.after.bodies[0].velocity_m_s.x;
  const double second_m_s = bench.after.bodies[1].velocity_m_s.x;
  EXPECT_GT(second_m_s, 0.2);
  EXPECT_NEAR(0.1 * (first_m_s + second_m_s), 0.1 * 0.5, tolerance(1e-12));
}

TEST(RestingBodies, StackWhoseTopTheHandMoves_IsAwakeAsAWhole) {
  // The palm's side comes down on the upper of two blocks; both yield by the same amount.
  const Models m = load(shippedFiles());
  AxisPosition above(6);
  above[2] = 0.05;
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  const double lowest_m = -reach(m.hand, above, down);
  const ArticulatedBody hand = handAt(m.hand, above);
  Eigen::Vector3d under = Eigen::Vector3d::Zero();
  for (const Capsule& c : m.hand.capsules) {
    for (const Eigen::Vector3d& end : {c.a_m, c.b_m}) {
      const Eigen::Vector3d at = hand.linkPose(c.link) * end;
      if (at.z() - c.radius_m < lowest_m + 1e-6) under = at;
    }
  }
  const double top_m = lowest_m - 0.003;
  SceneModel scene = onEarth({fixedBox({under.x(), under.y(), top_m - 0.09}, {0.3, 0.3, 0.02}),
                              block({under.x(), under.y(), top_m - 0.06}, 0.04, 0.1),
                              block({under.x(), under.y(), top_m - 0.02}, 0.04, 0.1)});
  Bench bench(defaultEngine(), scene);
  ASSERT_TRUE(bench.world->placeHand(above));
  AxisPosition q = above;
  for (int k = 0; k < 400; ++k) {
    q[2] = above[2] - 0.006 * std::min(1.0, k / 100.0);
    ASSERT_NO_FATAL_FAILURE(bench.step(q, AxisVelocity(6)));
  }
  ASSERT_GT(bench.touching.count, 0);
  double push_n = 0.0;
  for (int i = 0; i < bench.touching.count; ++i) {
    push_n += bench.touching.points[i].force_n.z;
  }
  // The force that holds the hand up is the requested effort: M_r z̈ = 0.
  EXPECT_GT(push_n, 1.0);
  EXPECT_NEAR(push_n, -bench.asked[2], tolerance(0.05) * push_n);
}

/// The engine considers only bodies around the hand. A body placed near the hand and a body that
/// the hand travels to must carry it alike: at rest they push with the requested effort.
TEST(RestingBodies, FarFromTheHand_CarryItWhenPlacedOrReached) {
  const Models m = load(shippedFiles());
  const double lowest_m = -reach(m.hand, aside(), -Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d size_m(0.6, 0.6, 0.02);
  const auto slabBelow = [&](double gap_m) {
    return Eigen::Vector3d(0.0, 0.0, lowest_m - gap_m - 0.01);
  };
  const double far_m = 0.25;
  for (const bool put_there : {true, false}) {
    SCOPED_TRACE(put_there ? "put there" : "travelled to");
    Bench bench(defaultEngine(), weightless({fixedBox(slabBelow(far_m), size_m)}));
    ASSERT_TRUE(bench.world->placeHand(aside()));
    ASSERT_NO_FATAL_FAILURE(run(bench, 50));
    ASSERT_EQ(bench.touching.count, 0);
    const double gap_m = put_there ? 1e-3 : far_m;
    if (put_there) put(bench, 0, slabBelow(gap_m), Eigen::Vector3d::Zero());
    AxisPosition q = aside();
    for (int k = 0; k < 1000; ++k) {
      q[2] = aside()[2] - std::min(5e-4 * k, gap_m + 2e-3);
      ASSERT_NO_FATAL_FAILURE(bench.step(q, AxisVelocity(6)));
    }
    double push_n = 0.0;
    for (int i = 0; i < bench.touching.count; ++i) push_n += bench.touching.points[i].force_n.z;
    EXPECT_GT(push_n, 1.0);
    EXPECT_NEAR(push_n, -bench.asked[2], tolerance(0.02) * push_n);
  }
}

}  // namespace
}  // namespace wholehand::test
