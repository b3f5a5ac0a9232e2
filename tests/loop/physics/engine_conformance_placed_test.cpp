// Behaviour of every engine when an exercise places bodies near the hand.
#include "loop/physics/engine_bench.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/tolerance.hpp"

#include <cmath>
#include <cstring>

namespace wholehand::test {
namespace {

BodyPlacements place(int body, const Eigen::Vector3d& at_m,
                     const Eigen::Vector3d& velocity_m_s = Eigen::Vector3d::Zero(),
                     const Eigen::Quaterniond& turned = Eigen::Quaterniond::Identity()) {
  BodyPlacements placements;
  placements.count = 1;
  BodyPlacement& item = placements.items[0];
  item.body = body;
  item.position_m = Vec3::from(at_m);
  item.orientation_xyzw = QuatXyzw::from(turned);
  item.velocity_m_s = Vec3::from(velocity_m_s);
  return placements;
}

WHOLEHAND_ENGINES(PlacedBody);
WHOLEHAND_ENGINES_OF_CONTACT_LAWS(PressedBody);
WHOLEHAND_ENGINES(SlidingFixedBody);
WHOLEHAND_ENGINES_OF_CONTACT_LAWS(WedgedHand);
WHOLEHAND_ENGINES_OF_CONTACT_LAWS(SlidingWall);

/// A body whose principal axes are not its own: a bar along (1, 1, 0).
SceneBody slantedBar(bool fixed) {
  SceneBody bar = fixedBox({0.3, 0.3, 0.3}, {0.02, 0.02, 0.2});
  bar.fixed = fixed;
  bar.mass_kg = fixed ? 0.0 : 0.2;
  bar.inertia_kg_m2 << 4e-4, -3e-4, 0.0, -3e-4, 4e-4, 0.0, 0.0, 0.0, 7e-4;
  bar.com_m = {0.01, 0.0, 0.0};
  return bar;
}

TEST_P(PlacedBody, FixedOrFree_IsAtItsPlacement) {
  const Eigen::Quaterniond turned = Eigen::Quaterniond(0.8, 0.3, -0.4, 0.2).normalized();
  const Eigen::Vector3d at_m(0.4, 0.2, 0.3), velocity_m_s(0.1, 0.0, -0.2);
  for (const bool fixed : {true, false}) {
    Bench bench(GetParam(), weightless({slantedBar(fixed)}));
    ASSERT_TRUE(bench.world->placeHand(AxisPosition(6)));
    bench.world->placeBodies(place(0, at_m, velocity_m_s, turned));
    const BodyState there = look(*bench.world).bodies[0];
    EXPECT_LE((there.position_m.eigen() - at_m).norm(), 1e-15);
    EXPECT_LE(there.orientation_xyzw.eigen().angularDistance(turned), 1e-7);
    EXPECT_LE((there.velocity_m_s.eigen() - velocity_m_s).norm(), 1e-15);
    bench.step(AxisPosition(6), AxisVelocity(6));
    const BodyState next = bench.after.bodies[0];
    // A free body flies on without rotation; a fixed one stays until it is placed again.
    const Eigen::Vector3d way_m = (fixed ? 0.0 : 1e-3) * velocity_m_s;
    EXPECT_LE((next.position_m.eigen() - at_m - way_m).norm(), 1e-12);
    EXPECT_LE(next.orientation_xyzw.eigen().angularDistance(turned), 1e-7);
    EXPECT_LE(next.angular_velocity_rad_s.eigen().norm(), 1e-12);
    bench.step(AxisPosition(6), AxisVelocity(6));
    EXPECT_EQ(bench.after.bodies[0].velocity_m_s.eigen().norm() == 0.0, fixed);
  }
}

TEST_P(PlacedBody, RotatingBody_StopsRotatingWhenPlaced) {
  // The hand hits the body and makes it spin.
  Bench bench(GetParam(), weightless({ball({0.09, 0.075, 0.0}, 0.03, 0.1)}));
  AxisPosition q(6);
  ASSERT_TRUE(bench.world->placeHand(q));
  for (int k = 0; k < 300; ++k) {
    q[1] = 0.06 * std::sin(4.0 * k * 1e-3);
    ASSERT_NO_FATAL_FAILURE(bench.step(q, AxisVelocity(6)));
  }
  ASSERT_GT(bench.after.bodies[0].angular_velocity_rad_s.eigen().norm(), 0.01);
  bench.world->placeBodies(place(0, {0.3, 0.3, 0.3}));
  const BodyState there = look(*bench.world).bodies[0];
  EXPECT_EQ(there.angular_velocity_rad_s.eigen().norm(), 0.0);
  EXPECT_EQ(there.velocity_m_s.eigen().norm(), 0.0);
}

TEST_P(PlacedBody, InvalidPlacement_LeavesTheBodyInPlace) {
  Bench bench(GetParam(), weightless({ball({0.3, 0.3, 0.3}, 0.03, 0.0)}));
  ASSERT_TRUE(bench.world->placeHand(AxisPosition(6)));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BodyPlacements bad = place(0, {nan, 0.0, 0.0});
  bench.world->placeBodies(bad);
  bad = place(0, {0.0, 0.0, 0.0});
  bad.items[0].orientation_xyzw = {0.0, 0.0, 0.0, 0.0};
  bench.world->placeBodies(bad);
  for (const int nobody : {-1, 1, 99}) bench.world->placeBodies(place(nobody, {0.1, 0.1, 0.1}));
  EXPECT_EQ(look(*bench.world).bodies[0].position_m.x, 0.3);
}

/// A fixed wall of 10 cm to the left of the palm, with its face `gap_m` from the hand.
struct Slide {
  double face_m;
  Bench bench;
  Slide(const std::string& engine, double gap_m)
      : face_m(reach(load(shippedFiles()).hand, AxisPosition(6), Eigen::Vector3d::UnitY()) + gap_m),
        bench(engine, weightless({wall(Eigen::Vector3d::UnitY(), face_m)})) {}
  /// Places the moving wall with its face at `face_now_m`.
  void put(double face_now_m, const Eigen::Vector3d& velocity_m_s, double along_m = 0.0) {
    bench.world->placeBodies(place(0, {along_m, face_now_m + 0.05, 0.0}, velocity_m_s));
  }
};

/// The hand cannot make room, so each contact must press by its depth only, for any time. With hard
/// rows the forces of the two walls grew to 2.3 kN.
TEST_P(WedgedHand, BetweenWallsThatAreTooNear_IsPressedByTheDepthOnly) {
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Models m = load(shippedFiles());
  const double left_m = reach(m.hand, AxisPosition(6), y);
  const double right_m = reach(m.hand, AxisPosition(6), -y);
  const double apart_m = 5e-3, depth_m = 2e-5, speed_m_s = 0.05;
  Bench bench(GetParam(), weightless({wall(y, left_m + apart_m), wall(-y, right_m + apart_m)}));
  ASSERT_TRUE(bench.world->placeHand(AxisPosition(6)));
  double largest_n = 0.0, off_n = 0.0;
  int pressed = 0;
  for (int k = 0; k < 1500; ++k) {
    const double travel_m = std::min(speed_m_s * k * kPeriod_s, apart_m + depth_m);
    const double now_m_s = travel_m < apart_m + depth_m ? speed_m_s : 0.0;
    const double out_m = apart_m - travel_m + 0.05;
    BodyPlacements both = place(0, (left_m + out_m) * y, -now_m_s * y);
    both.items[both.count++] = place(1, -(right_m + out_m) * y, now_m_s * y).items[0];
    bench.world->placeBodies(both);
    ASSERT_NO_FATAL_FAILURE(bench.step(AxisPosition(6), AxisVelocity(6)));
    if (k < 1000) continue;
    pressed += bench.touching.count > 1 ? 1 : 0;
    for (int i = 0; i < bench.touching.count; ++i) {
      const Contact& c = bench.touching.points[i];
      largest_n = std::max(largest_n, std::abs(c.force_n.y));
      const double depth_n = 2.5e6 * std::max(0.0, -c.distance_m - 1e-5);
      off_n = std::max(off_n, std::abs(std::abs(c.force_n.y) - depth_n));
    }
  }
  EXPECT_EQ(pressed, 500);
  figure("force of a contact between walls 40 um too near, " + GetParam(), largest_n, "N");
  EXPECT_LE(largest_n, tolerance(100.0));  // a few times a device's largest force
  // `bullet` states its stiffness: 2.5 N/µm beyond the 10 µm at which contacts rest. Each contact
  // has its own depth: half of 40 µm, 25 N, less the hand's compliance.
  if (GetParam() == "bullet") {
    EXPECT_NEAR(largest_n, 25.0, tolerance(1.25));
    EXPECT_LE(off_n, tolerance(0.1));
  }
}

TEST_P(SlidingWall, WallThatMeetsTheHand_PushesItAtItsOwnSpeed) {
  Slide slide(GetParam(), 0.01);
  ASSERT_TRUE(slide.bench.world->placeHand(AxisPosition(6)));
  const double speed_m_s = 0.2;
  double deepest_m = 0.0, last_gap_m = 0.0, peak_n = 0.0, settled_n = 0.0;
  for (int k = 0; k < 400; ++k) {
    const double travel_m = std::min(speed_m_s * k * 1e-3, 0.03);
    const double now_m_s = travel_m < 0.03 ? speed_m_s : 0.0;
    slide.put(slide.face_m - travel_m, {0.0, -now_m_s, 0.0});
    ASSERT_NO_FATAL_FAILURE(slide.bench.step(AxisPosition(6), AxisVelocity(6)));
    // The wall's position at the end of the step.
    const double face_m = slide.face_m - travel_m - now_m_s * 1e-3;
    last_gap_m =
        face_m - reach(slide.bench.models.hand, slide.bench.after.q_s, Eigen::Vector3d::UnitY());
    deepest_m = std::max(deepest_m, -last_gap_m);
    double push_n = 0.0;
    for (int i = 0; i < slide.bench.touching.count; ++i) {
      push_n -= slide.bench.touching.points[i].force_n.y;
    }
    peak_n = std::max(peak_n, push_n);
    if (k >= 300) settled_n = push_n;
    ASSERT_LT(slide.bench.after.qd_s.vec().head<3>().norm(), 2.0 * speed_m_s) << k;
  }
  figure("sliding wall, deepest in the hand", deepest_m * 1e3, "mm");
  figure("sliding wall, peak push", peak_n, "N");
  const Bounds& bounds = boundsOf(GetParam());
  EXPECT_LE(deepest_m, tolerance(bounds.sliding_wall_m));
  EXPECT_NEAR(last_gap_m, 0.0, tolerance(bounds.sliding_wall_m));
  // At rest the wall carries the coupling's effort on y and holds what it has pushed away.
  Bench& bench = slide.bench;
  EXPECT_LT(bench.after.qd_s.vec().norm(), 1e-4);
  const double asked_n = bench.body.reducedInertia()(1, 1) * 4e3 * -bench.after.q_s[1];
  EXPECT_GT(asked_n, 0.3);
  EXPECT_NEAR(settled_n, asked_n, tolerance(bounds.carried_share) * asked_n);
  // The hand's 0.25 kg reach 0.2 m/s within a few periods, not in a single one.
  EXPECT_LT(peak_n, 0.25 * speed_m_s / 1e-3 + settled_n);
}

TEST_P(SlidingFixedBody, PressedByTheHand_CarriesItAlong) {
  Slide slide(GetParam(), 0.0);
  AxisPosition free(6), pressed(6);
  free[1] = -0.002;
  pressed[1] = 0.01;
  ASSERT_TRUE(slide.bench.world->placeHand(free));
  for (int k = 0; k < 300; ++k) {
    ASSERT_NO_FATAL_FAILURE(slide.bench.step(pressed, AxisVelocity(6)));
  }
  // Target and wall move along x together: nothing slips, so the hand moves with them.
  const double from_m = slide.bench.after.q_s[0], speed_m_s = 0.1;
  AxisVelocity along(6);
  along[0] = speed_m_s;
  for (int k = 0; k < 200; ++k) {
    pressed[0] = speed_m_s * k * 1e-3;
    slide.put(slide.face_m, {speed_m_s, 0.0, 0.0}, pressed[0]);
    ASSERT_NO_FATAL_FAILURE(slide.bench.step(pressed, along));
    if (k < 50) continue;  // friction needs a while to accelerate the hand
    ASSERT_GT(slide.bench.touching.count, 0);
    ASSERT_NEAR(slide.bench.after.qd_s[0], speed_m_s, 0.1 * speed_m_s) << k;
  }
  EXPECT_NEAR(slide.bench.after.q_s[0] - from_m, speed_m_s * 0.2, tolerance(1e-3));
  // Without a new placement the body stands and holds the hand by friction.
  for (int k = 0; k < 100; ++k) {
    ASSERT_NO_FATAL_FAILURE(slide.bench.step(pressed, AxisVelocity(6)));
  }
  EXPECT_NEAR(slide.bench.after.qd_s[0], 0.0, tolerance(1e-3));
}

TEST_P(PressedBody, PlacedOnTheOtherSideOfAFinger_ReleasesWithoutAKick) {
  const Models m = load(shippedFiles());
  AxisPosition free(6), pressed(6);
  free[1] = -0.002;
  pressed[1] = 0.005;
  const ArticulatedBody at = handAt(m.hand, AxisPosition(6));
  const Capsule& bone = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                      [](const Capsule& c) { return c.name == "middle_middle"; });
  const double radius_m = 0.01;
  const Eigen::Vector3d middle_m = at.linkPose(bone.link) * (0.5 * (bone.a_m + bone.b_m));
  const double away_m = bone.radius_m + radius_m;
  Bench bench(GetParam(),
              weightless({ball(middle_m + away_m * Eigen::Vector3d::UnitY(), radius_m, 0.0)}));
  ASSERT_TRUE(bench.world->placeHand(free));
  for (int k = 0; k < 300; ++k) ASSERT_NO_FATAL_FAILURE(bench.step(pressed, AxisVelocity(6)));
  ASSERT_EQ(bench.touching.count, 1);
  const Contact before = bench.touching.points[0];
  const AxisPosition held = bench.after.q_s;
  // The placement is so near that an engine still compares the two; an old contact point is now 4
  // cm deep along its normal.
  const double across_m = 2.0 * m.hand.capsules[before.capsule].radius_m + radius_m + 6e-4;
  bench.world->placeBodies(place(0, before.point_m.eigen() + across_m * before.normal.eigen()));
  ASSERT_NO_FATAL_FAILURE(bench.step(held, AxisVelocity(6)));
  EXPECT_EQ(bench.touching.count, 0);
  EXPECT_LT((bench.after.q_s.vec() - held.vec()).norm(), boundsOf(GetParam()).let_go_m);
}

TEST_P(PlacedBody, RepeatedPlacementsAndQueries_NeverAllocate) {
  if (!allocationCountingAvailable()) GTEST_SKIP() << "malloc is not ours to count";
  Models m = load(shippedFiles());
  SceneBody bottle = ball({0.1, 0.06, 0.0}, 0.025, 0.0);
  bottle.name = "bottle";
  SceneBody free = ball({0.3, 0.3, 0.0}, 0.025, 0.1);
  SceneModel scene = weightless({bottle, free, fixedBox({0.3, 0.3, -0.05}, {0.2, 0.2, 0.05})});
  Bench bench(GetParam(), scene);
  bench.query = {0b011, 0};
  AxisPosition q(6);
  ASSERT_TRUE(bench.world->placeHand(q));
  const AllocationScope scope;
  int touching = 0;
  for (int k = 0; k < 1500; ++k) {
    const double t = k * 1e-3;
    q[3] = 1.0 + std::sin(3.0 * t);
    bench.query.closure_body = k % 400 < 300 ? k / 700 : -1;
    BodyPlacements placements =
        place(0, {0.1 + 0.02 * std::sin(5.0 * t), 0.06, 0.0}, {0.1 * std::cos(5.0 * t), 0.0, 0.0});
    if (k % 200 < 50) placements.count = 0;  // no placement for a while: it stands
    if (k % 250 == 0) placements = place(1, {0.09, 0.06 + 1e-4 * k, 0.02 * std::sin(t)});
    if (k % 300 == 299) placements = place(0, {0.1, 0.3, 0.1 * std::sin(t)});
    bench.world->placeBodies(placements);
    bench.step(q, AxisVelocity(6));
    touching += bench.touching.count;
  }
  EXPECT_GT(touching, 100);
  EXPECT_EQ(scope.allocations(), 0U);
}

TEST_P(PlacedBody, TwoEqualWorlds_GiveTheSameBits) {
  const auto run = [&] {
    Slide slide(GetParam(), 0.01);
    slide.bench.query = {1, 0};
    EXPECT_TRUE(slide.bench.world->placeHand(AxisPosition(6)));
    for (int k = 0; k < 150; ++k) {
      slide.put(slide.face_m - 2e-4 * k, {0.0, -0.2, 0.0});
      slide.bench.step(AxisPosition(6), AxisVelocity(6));
    }
    return slide.bench.probed;
  };
  const TickRecord a = run(), b = run();
  EXPECT_EQ(0, std::memcmp(a.theta.data(), b.theta.data(), sizeof(double) * 19));
  EXPECT_EQ(0, std::memcmp(a.closure.data(), b.closure.data(), sizeof(double) * 6));
}

}  // namespace
}  // namespace wholehand::test
