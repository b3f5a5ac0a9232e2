// Messages of every engine for scenes that it cannot take; same bits; no allocation.
#include "loop/physics/engine_bench.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/contains.hpp"
#include "support/tolerance.hpp"

#include <cmath>
#include <cstring>

namespace wholehand::test {
namespace {

WHOLEHAND_ENGINES(Determinism);
WHOLEHAND_ENGINES(BadScene);
WHOLEHAND_ENGINES_OF_CONTACT_LAWS(ManyWalls);
WHOLEHAND_ENGINES(PlaceHand);

TEST_P(PlaceHand, HandInsideABody_NamesBodyAndPart) {
  const Models m = load(shippedFiles());
  const ArticulatedBody at = handAt(m.hand, AxisPosition(6));
  const Capsule& tip = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                     [](const Capsule& c) { return c.name == "middle_distal"; });
  const SceneModel scene = weightless({ball(at.linkPose(tip.link) * tip.b_m, 0.004, 0.1)});
  const auto made = orThrow(buildWorld(GetParam(), m.hand, scene));
  PhysicsWorld& world = *made;
  const Expected<Done> placed = world.placeHand(AxisPosition(6));
  ASSERT_FALSE(placed);
  EXPECT_EQ(placed.errors()[0].key, "bodies.ball");
  EXPECT_TRUE(contains(placed.errors()[0].problem, "middle_distal")) << format(placed.errors());
  AxisPosition aside(6);
  aside[1] = 0.1;
  EXPECT_TRUE(world.placeHand(aside));
}

/// States of 1,000 steps in which the hand pushes balls while the fingers close.
std::vector<PhysicsState> pushed(const std::string& engine) {
  Bench bench(engine, weightless({ball({0.09, 0.075, 0.0}, 0.03, 0.1),
                                  fixedBox({0.09, 0.2, 0.0}, {0.3, 0.1, 0.3})}));
  AxisPosition q(6);
  EXPECT_TRUE(bench.world->placeHand(q));
  std::vector<PhysicsState> states;
  for (int k = 0; k < 1000; ++k) {
    q[1] = 0.06 * std::sin(4e-3 * k);
    q[3] = 0.8 + 0.6 * std::sin(2e-3 * k);
    bench.step(q, AxisVelocity(6));
    states.push_back(bench.after);
  }
  return states;
}

TEST_P(Determinism, TwoEqualWorlds_AgreeToTheBit) {
  const std::vector<PhysicsState> one = pushed(GetParam()), other = pushed(GetParam());
  ASSERT_EQ(one.size(), other.size());
  const auto same = [](const auto& a, const auto& b) { return std::memcmp(&a, &b, sizeof a) == 0; };
  for (std::size_t k = 0; k < one.size(); ++k) {
    ASSERT_TRUE(same(one[k].q_s, other[k].q_s)) << k;
    ASSERT_TRUE(same(one[k].qd_s, other[k].qd_s)) << k;
    ASSERT_TRUE(same(one[k].bodies[0], other[k].bodies[0])) << k;
  }
  EXPECT_GT((one.back().bodies[0].position_m.eigen() - Eigen::Vector3d(0.09, 0.075, 0.0)).norm(),
            1e-3)
      << "it was pushed";
}

TEST_P(BadScene, NonFiniteDrive_IsAFaultAndMovesNothing) {
  Bench bench(GetParam(), weightless({ball({0.3, 0.3, 0.0}, 0.02, 0.1)}));
  ASSERT_TRUE(bench.world->placeHand(AxisPosition(6)));
  ASSERT_NO_FATAL_FAILURE(bench.step(AxisPosition(6), AxisVelocity(6)));
  const PhysicsState before = bench.after;
  HandDrive drive;
  drive.effort = AxisEffort(6, std::numeric_limits<double>::quiet_NaN());
  drive.torque = JointEffort(bench.models.hand.joint_count, drive.effort[0]);
  drive.reduced_inertia_inverse = &bench.body.reducedInertiaInverse();
  EXPECT_NE(bench.world->step(drive, kPeriod_s), Fault::kNone);
  PhysicsState after;
  EXPECT_EQ(bench.world->observe(after), Fault::kNone);
  EXPECT_EQ(0, std::memcmp(&before.q_s, &after.q_s, sizeof before.q_s));
}

TEST_P(BadScene, LargestNumberOfBodies_StepsWithoutAllocating) {
  if (!allocationCountingAvailable()) GTEST_SKIP() << "malloc is not ours to count";
  std::vector<SceneBody> bodies;
  for (int i = 0; i < boundsOf(GetParam()).bodies; ++i) {
    bodies.push_back(ball({0.3 + 0.05 * (i % 32), 0.3 + 0.05 * (i / 32), 0.0}, 0.02, 0.1));
  }
  Bench bench(GetParam(), weightless(bodies));
  ASSERT_TRUE(bench.world->placeHand(AxisPosition(6)));
  const AllocationScope scope;
  for (int k = 0; k < 50; ++k) bench.step(AxisPosition(6), AxisVelocity(6));
  EXPECT_EQ(scope.allocations(), 0U);
}

TEST_P(ManyWalls, ThirtyAtOnePlace_CarryTheForceOfOne) {
  const Models m = load(shippedFiles());
  const Eigen::Vector3d aside = -Eigen::Vector3d::UnitY();
  const double face_m = reach(m.hand, AxisPosition(6), aside) + 1e-3;
  Bench bench(GetParam(), weightless(std::vector<SceneBody>(30, wall(aside, face_m))));
  AxisPosition q(6);
  ASSERT_TRUE(bench.world->placeHand(q));
  for (int k = 0; k < 700; ++k) {
    q[1] = -0.01 * std::min(1.0, k / 100.0);
    ASSERT_NO_FATAL_FAILURE(bench.step(q, AxisVelocity(6)));
    ASSERT_LE(bench.touching.count, kMaxContacts);
  }
  double push_n = 0.0;
  for (int i = 0; i < bench.touching.count; ++i) {
    push_n += bench.touching.points[i].force_n.y;
  }
  const double asked_n = bench.body.reducedInertia()(1, 1) * 4e3 * (bench.after.q_s[1] - q[1]);
  EXPECT_GT(asked_n, 5.0);
  EXPECT_NEAR(push_n, asked_n, tolerance(boundsOf(GetParam()).carried_share) * asked_n);
}

TEST(Engines, EnginesForPersons_MustSatisfyEveryLaw) {
  for (const std::string& name : builtEngines(true)) {
    EXPECT_TRUE(boundsOf(name).contact_laws) << name;
  }
}

TEST(Engines, UnknownName_IsRefusedWithTheKnownNames) {
  const Models m = load(shippedFiles());
  const auto world = buildWorld("havok", m.hand, m.scene);
  ASSERT_FALSE(world);
  std::string names;
  for (const std::string& name : builtEngines()) names += (names.empty() ? "" : " or ") + name;
  EXPECT_EQ(format(world.errors()), "--engine = havok: is not a known engine; use " + names);
}

TEST(Engines, EngineNotBuiltIn_IsRefusedWithTheWayToBuildIt) {
  const Models m = load(shippedFiles());
  const std::vector<Engine> known{{"absent", "", {}, "install libabsent-dev", ""}};
  const auto world = buildWorld("absent", m.hand, m.scene, known);
  ASSERT_FALSE(world);
  EXPECT_EQ(format(world.errors()),
            "--engine = absent: is not built into this program; install libabsent-dev");
}

TEST(Engines, EngineNotForPersons_IsRefusedForRealDevices) {
  std::vector<Engine> known = engines();
  EXPECT_TRUE(refuseForPersons(defaultEngine()).empty());
  known.front().persons_refused_because = "of a test";
  known.push_back({"absent", "", {}, "install libabsent-dev", ""});
  EXPECT_EQ(format(refuseForPersons("bullet", known)),
            "--engine = bullet: is not for real devices: of a test; use --engine bullet");
  EXPECT_EQ(format(refuseForPersons("absent", known)),
            "--engine = absent: is not built into this program; install libabsent-dev");
}

TEST(Engines, LabEngine_IsRefusedByNameWhereTheLabIsNotBuilt) {
  for (const Engine& engine : labEngines()) {
    if (engine.build) GTEST_SKIP() << "the lab is built";
    const auto rig =
        buildRig(load(shippedFiles()), std::make_unique<RestingDevice>(), with(engine.name));
    ASSERT_FALSE(rig);
    EXPECT_EQ(format(rig.errors()),
              "--engine = " + engine.name +
                  ": is not built into this program; it is in the lab: configure with "
                  "-DWHOLEHAND_LAB=ON (./check --full does)");
  }
}

TEST(Engines, FirstEngine_IsTheDefaultAndBuiltIn) {
  EXPECT_EQ(defaultEngine(), "bullet");
  EXPECT_TRUE(engines().front().build);
}

}  // namespace
}  // namespace wholehand::test
