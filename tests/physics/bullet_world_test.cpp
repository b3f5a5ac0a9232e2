// Laws of physics that the Bullet world must keep, whatever its solver does inside.
#include "physics/bullet_bench.hpp"
#include "physics/palm_distance.hpp"
#include "support/tolerance.hpp"

#include <array>
#include <cmath>
#include <random>

namespace wholehand::test {
namespace {

TEST(FreeHand, UnderRandomEffort_FollowsItsReducedInertia) {
  Models m = load(shippedFiles());
  // Free: a walk of random efforts goes beyond the joints' ranges, where their ends would hold it.
  m.hand.self_contacts.clear();
  for (HandLink& link : m.hand.links) link.lower = -10.0, link.upper = 10.0;
  BulletWorld world(m.hand, m.scene);
  ASSERT_TRUE(world.placeHand(m.hand.reference));
  ArticulatedBody body(m.hand);
  std::mt19937_64 random(3);
  const auto draw = [&] { return 2.0 * static_cast<double>(random() >> 11U) * 0x1.0p-53 - 1.0; };
  double worst = 0.0;
  for (int k = 0; k < 500; ++k) {
    const WorldState s = look(world);
    ASSERT_TRUE(body.update(s.theta, s.theta_dot, m.scene.gravity_m_s2));
    AxisEffort f_s(m.hand.axis_count);
    for (int a = 0; a < f_s.size(); ++a) f_s[a] = draw() * 20.0 * body.reducedInertia()(a, a);
    HandDrive drive;
    drive.effort = f_s;
    body.distribute(f_s, drive.torque);
    drive.reduced_inertia_inverse = &body.reducedInertiaInverse();
    ASSERT_EQ(world.step(drive, kPeriod_s), Fault::kNone);
    const WorldState next = look(world);
    // q̈ = M_r⁻¹ f_s: gravity and all velocity terms are carried by h. Symplectic Euler, as Bullet.
    const Eigen::VectorXd rate =
        s.qd_s.vec() + kPeriod_s * body.reducedInertiaInverse() * f_s.vec();
    const Eigen::VectorXd place = s.q_s.vec() + kPeriod_s * rate;
    worst = std::max({worst, (next.qd_s.vec() - rate).cwiseAbs().maxCoeff(),
                      (next.q_s.vec() - place).cwiseAbs().maxCoeff()});
  }
  figure("free hand against M_r^-1 f_s, worst change of velocity", worst, "m/s or rad/s");
  EXPECT_LE(worst, tolerance(1e-9));
}

/// The world's mirror image in y, in the device's coordinates.
AxisPosition mirrored(AxisPosition q) {
  q[1] = -q[1];
  return q;
}

/// Swings sideways into what stands there while the fingers close.
AxisPosition swing(double t, double sign) {
  AxisPosition q(6);
  q[1] = sign * 0.06 * std::sin(4.0 * t);
  q[0] = 0.01 * std::sin(3.0 * t);
  q[3] = 0.8 + 0.6 * std::sin(2.0 * t);
  q[4] = 0.6;
  q[5] = 0.3;
  return q;
}

TEST(FreeBodies, PushedByTheHand_ChangeTheirMomentumByMinusTheContactForces) {
  // The hand pushes one ball, that one the other: what they give each other cancels.
  Bench bench(
      weightless({ball({0.09, 0.075, 0.0}, 0.03, 0.1), ball({0.095, 0.142, 0.0}, 0.03, 0.2)}));
  ASSERT_TRUE(bench.world->placeHand(swing(0.0, 1.0)));
  const auto momentum = [](const WorldState& s) -> Eigen::Vector3d {
    return 0.1 * s.bodies[0].velocity_m_s.eigen() + 0.2 * s.bodies[1].velocity_m_s.eigen();
  };
  double worst = 0.0;
  int touched = 0;
  for (int k = 0; k < 1500; ++k) {
    ASSERT_NO_FATAL_FAILURE(bench.step(swing(k * kPeriod_s, 1.0), AxisVelocity(6)));
    Eigen::Vector3d on_hand = Eigen::Vector3d::Zero();
    for (int i = 0; i < bench.touching.count; ++i) {
      on_hand += bench.touching.points[i].force_n.eigen();
    }
    touched += bench.touching.count > 0 ? 1 : 0;
    const Eigen::Vector3d change = momentum(bench.after) - momentum(bench.state);
    worst = std::max(worst, (change + kPeriod_s * on_hand).norm());  // action = reaction
  }
  EXPECT_GT(touched, 20);
  EXPECT_GT(bench.after.bodies[1].velocity_m_s.eigen().norm(), 0.01);  // the second was hit
  figure("momentum of pushed balls against the contact forces", worst, "N s");
  EXPECT_LE(worst, tolerance(1e-12));
}

/// A block on a fixed slab, gravity tilted by a slope. Its speed down the slope after 0.5 s [m/s].
double slidingSpeed(double slope_rad) {
  SceneBody block = fixedBox({0.0, 0.0, 0.3}, {0.1, 0.1, 0.02});
  block.name = "block";
  block.fixed = false;
  block.mass_kg = 0.2;
  block.inertia_kg_m2 =
      Eigen::Vector3d(1.7333e-4, 1.7333e-4, 3.3333e-4).asDiagonal();  // m (a² + b²) / 12
  SceneModel scene = weightless({fixedBox({0.0, 0.0, 0.28}, {3.0, 0.5, 0.02}), block});
  scene.gravity_m_s2 = 9.81 * Eigen::Vector3d(std::sin(slope_rad), 0.0, -std::cos(slope_rad));
  Bench bench(scene);
  const AxisPosition far_below(6);
  EXPECT_TRUE(bench.world->placeHand(far_below));
  for (int k = 0; k < 500; ++k) bench.step(far_below, AxisVelocity(6));
  return bench.after.bodies[1].velocity_m_s.x;
}

TEST(Friction, BetweenBodies_IsCoulombs) {
  // μ = 0.8 on both. Below tan α = 0.8 it stays, above it slides with g (sin α − μ cos α).
  EXPECT_NEAR(slidingSpeed(std::atan(0.7)), 0.0, tolerance(1e-4));
  const double steep = std::atan(1.2);
  const double expected = 0.5 * 9.81 * (std::sin(steep) - 0.8 * std::cos(steep));
  EXPECT_NEAR(slidingSpeed(steep), expected, tolerance(0.01) * expected);
}

TEST(TableScene, LeftAlone_StandsStill) {
  const Models m = load(shippedFiles("lambda-pride", "table"));
  Bench bench(m.scene);
  AxisPosition clear(6);
  clear[0] = -0.08, clear[2] = 0.11;
  ASSERT_TRUE(bench.world->placeHand(clear));
  const WorldState before = look(*bench.world);
  for (int k = 0; k < 1500; ++k) {
    ASSERT_NO_FATAL_FAILURE(bench.step(clear, AxisVelocity(6)));
    ASSERT_EQ(bench.touching.count, 0);
  }
  double moved_m = 0.0, turned_rad = 0.0;
  for (int i = 0; i < before.body_count; ++i) {
    const BodyState &a = before.bodies[i], &b = bench.after.bodies[i];
    moved_m = std::max(moved_m, (a.position_m.eigen() - b.position_m.eigen()).norm());
    turned_rad = std::max(turned_rad,
                          a.orientation_xyzw.eigen().angularDistance(b.orientation_xyzw.eigen()));
  }
  figure("largest move of a body left alone for 1.5 s", moved_m * 1e3, "mm");
  EXPECT_LE(moved_m, tolerance(2e-4));
  EXPECT_LE(turned_rad, tolerance(5e-3));
}

TEST(LeftHand, InTheMirroredScene_DoesTheMirrorImage) {
  // Frictionless, so that where the solver lays its tangents does not matter.
  SceneBody right = ball({0.09, 0.075, 0.0}, 0.03, 0.1),
            left = ball({0.09, -0.075, 0.0}, 0.03, 0.1);
  right.friction = left.friction = 0.0;
  Bench r(weightless({right})), l(weightless({left}), "adult-median-left");
  ASSERT_TRUE(r.world->placeHand(swing(0.0, 1.0)));
  ASSERT_TRUE(l.world->placeHand(mirrored(swing(0.0, 1.0))));
  double hand = 0.0, body = 0.0;
  int touched = 0;
  for (int k = 0; k < 700; ++k) {
    const double t = k * kPeriod_s;
    ASSERT_NO_FATAL_FAILURE(r.step(swing(t, 1.0), AxisVelocity(6)));
    ASSERT_NO_FATAL_FAILURE(l.step(mirrored(swing(t, 1.0)), AxisVelocity(6)));
    hand = std::max(hand, (r.after.q_s.vec() - mirrored(l.after.q_s).vec()).cwiseAbs().maxCoeff());
    const Vec3 a = r.after.bodies[0].position_m, b = l.after.bodies[0].position_m;
    body = std::max(body, Eigen::Vector3d(a.x - b.x, a.y + b.y, a.z - b.z).norm());
    touched += r.touching.count > 0 ? 1 : 0;
  }
  EXPECT_GT(touched, 20);
  figure("left hand against the mirror image of the right", std::max(hand, body), "m or rad");
  EXPECT_LE(hand, tolerance(1e-7));
  EXPECT_LE(body, tolerance(1e-7));
}

TEST(Friction, WhileAGraspSlidesAndSticks_StaysInItsCone) {
  Models m = load(shippedFiles("lambda-pride", "table"));
  m.scene.hand_friction = 0.2;
  AxisPosition above(6), down(6);
  above[2] = down[2] = 0.11;
  above[0] = -0.08;
  down[0] = 0.03;
  down[2] = -0.02;
  down[3] = 2.0;
  down[5] = 1.0;
  const auto rig = buildScripted(m, moveAndHold(above, down, 900));
  ASSERT_TRUE(rig->renderer->arm());
  double worst = 0.0;
  int sliding = 0, points = 0;
  runTicks(*rig->renderer, 2500, [&](const TickRecord& r) {
    for (int i = 0; i < r.contact_count; ++i) {
      const Contact& c = r.contacts[i];
      const Eigen::Vector3d n = c.normal.eigen(), f = c.force_n.eigen();
      const double normal = f.dot(n), tangent = (f - normal * n).norm();
      // μ of a pair is √(μ_hand μ_body).
      const double mu = std::sqrt(0.2 * rig->models.scene.bodies[c.body].friction);
      EXPECT_GT(normal, 0.0) << "a contact never pulls";
      worst = std::max(worst, tangent / (mu * normal));
      sliding += tangent > 0.99 * mu * normal ? 1 : 0;
      ++points;
    }
  });
  EXPECT_GT(sliding, 10);      // the bound was met
  EXPECT_LT(sliding, points);  // and it also stuck
  figure("largest tangential over allowed friction force", worst, "");
  EXPECT_LE(worst, 1.0 + tolerance(1e-9));
}

/// A push along an axis of the device at its speed limit, far beyond a fixed box.
class Slam : public testing::TestWithParam<int> {};

TEST_P(Slam, IntoAFixedBoxAtTheSpeedLimit_DoesNotEnterIt) {
  const int axis = GetParam();
  Models m = load(shippedFiles());
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
  AxisPosition start(6);
  start[axis] = m.device.axes[axis].lower;
  const double face_m = reach(m.hand, start, along) + 0.04;
  m.scene.bodies = {wall(along, face_m)};
  const double speed = m.device.axes[axis].speed_limit;
  const double far = m.device.axes[axis].upper;
  const auto rig = buildScripted(m, [=](int read) {
    AxisPosition q = start;
    q[axis] = std::min(start[axis] + speed * kPeriod_s * read, far);
    q[3] = std::min(10.0 * kPeriod_s * read, 1.0);  // fingers close at their speed limit too
    return q;
  });
  ASSERT_TRUE(rig->renderer->arm());
  double before_m = -1.0, depth_m = -1.0, deepest_m = -1.0, stride_m = 0.0;
  const auto last = runTicks(*rig->renderer, 1500, [&](const TickRecord& r) {
    depth_m = reach(rig->models.hand, r.q_s, along) - face_m;
    if (r.tick > 0) stride_m = std::max(stride_m, depth_m - before_m);
    before_m = depth_m;
    deepest_m = std::max(deepest_m, depth_m);
    ASSERT_EQ(r.faults & kStopping, Fault::kNone);
  });
  EXPECT_GT(last->q_m[axis] - last->q_s[axis], 0.01);  // the device did go on
  figure("depth at the speed limit, axis " + m.device.axes[axis].name, deepest_m * 1e3, "mm");
  // A surface is seen at most one period's way too late, and what overlaps is pushed out again.
  EXPECT_LE(deepest_m, stride_m);
  EXPECT_LT(depth_m, 1e-4);
}
INSTANTIATE_TEST_SUITE_P(Axes, Slam, testing::Values(0, 1, 2));

TEST(PlaceHand, WhereABodyIs_NamesBodyAndPart) {
  const Models m = load(shippedFiles());
  const ArticulatedBody at = handAt(m.hand, AxisPosition(6));
  const Capsule& tip = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                     [](const Capsule& c) { return c.name == "middle_distal"; });
  BulletWorld world(m.hand, weightless({ball(at.linkPose(tip.link) * tip.b_m, 0.004, 0.1)}));
  const Expected<Done> placed = world.placeHand(AxisPosition(6));
  ASSERT_FALSE(placed);
  EXPECT_EQ(placed.errors()[0].key, "bodies.ball");
  EXPECT_NE(placed.errors()[0].problem.find("middle_distal"), std::string::npos)
      << format(placed.errors());
  AxisPosition aside(6);
  aside[1] = 0.1;
  EXPECT_TRUE(world.placeHand(aside));
}

TEST(PalmDistance, OfBallsAndBoxes_IsTheClosedForm) {
  const Models m = load(shippedFiles());
  AxisPosition q(6);
  q[0] = 0.02, q[1] = -0.03, q[2] = 0.04;
  const ArticulatedBody at = handAt(m.hand, q);
  const Capsule& hollow = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                        [](const Capsule& c) { return c.name == "hollow"; });
  const Pose& palm = at.linkPose(m.hand.palm_link);
  const Eigen::Vector3d a = palm * hollow.a_m, b = palm * hollow.b_m;
  const auto distance = [&](const SceneBody& body) {
    Bench bench(weightless({body}));
    EXPECT_TRUE(bench.world->placeHand(q));
    return bench.ask({}).palm_distance_m;
  };
  // A ball beside the segment's middle: the perpendicular distance less both radii.
  const Eigen::Vector3d beyond = (b - a).normalized();
  const Eigen::Vector3d volar = palm.rotation * -Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d aside = (volar - volar.dot(beyond) * beyond).normalized();
  EXPECT_NEAR(distance(ball(0.5 * (a + b) + 0.12 * aside, 0.03, 0.1)),
              0.12 - 0.03 - hollow.radius_m, tolerance(1e-5));
  // Beyond an end: the distance to that end.
  EXPECT_NEAR(distance(ball(b + 0.2 * beyond, 0.03, 0.1)), 0.2 - 0.03 - hollow.radius_m,
              tolerance(1e-5));
  // A wide box above: the higher end's height to its face.
  const double top = std::max(a.z(), b.z());
  EXPECT_NEAR(distance(fixedBox({0.0, 0.0, top + 0.2}, {1.0, 1.0, 0.1})),
              0.2 - 0.05 - hollow.radius_m, tolerance(1e-5));
  // Nothing: infinitely far.
  Bench empty(weightless({}));
  ASSERT_TRUE(empty.world->placeHand(q));
  EXPECT_EQ(empty.ask({}).palm_distance_m, std::numeric_limits<double>::infinity());
}

/// A ball somewhere about the middle of the palm's hollow, which looks along -z of the palm's
/// frame. Its distance is that of the segment between the hollow's ends, less both radii.
TEST(PalmDistance, OfATarget_IsNegativeUnlessItIsBeforeThePalm) {
  struct Place {
    Eigen::Vector3d way;  // in the palm's frame: distal, radial, dorsal
    bool before;
  };
  const std::array<Place, 9> places{{{{0, 0, -1}, true},
                                     {{0, 1, -1}, true},
                                     {{0, -1, -1}, true},
                                     {{0, 0, 1}, false},
                                     {{0, 1, 1}, false},
                                     {{0, -1, 1}, false},
                                     {{0, 1, -0.1}, false},
                                     {{0, -1, -0.1}, false},
                                     {{0, -1, 0.1}, false}}};
  for (const char* name : {"adult-median-right", "adult-median-left"}) {
    const Models m = load(shippedFiles("lambda-pride", "empty", name));
    const Pose palm = handAt(m.hand, AxisPosition(6)).linkPose(m.hand.palm_link);
    const Capsule& hollow = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                          [](const Capsule& c) { return c.name == "hollow"; });
    const Eigen::Vector3d along = (hollow.b_m - hollow.a_m).normalized();
    for (const Place& place : places) {
      SCOPED_TRACE(std::string(name) + testing::PrintToString(place.way.transpose()));
      const Eigen::Vector3d way = (place.way - place.way.dot(along) * along).normalized();
      const Eigen::Vector3d middle = 0.5 * (hollow.a_m + hollow.b_m);
      const SceneModel scene = weightless({ball(palm * (middle + 0.06 * way), 0.03, 0.1)});
      BodyState state;
      state.position_m = Vec3::from(scene.bodies[0].pose.translation_m);
      const auto found = PalmDistance(m.hand, scene)(palm, &state, 1U);
      const double gap_m = 0.06 - 0.03 - hollow.radius_m;
      EXPECT_EQ(found.target, 0);
      EXPECT_NEAR(found.any_m, gap_m, tolerance(1e-6));
      EXPECT_NEAR(found.target_m, place.before ? gap_m : -gap_m, tolerance(1e-6));
    }
  }
}

TEST(PalmDistance, OfATargetThatTouchesThePalm_IsNeverNegative) {
  const Models m = load(shippedFiles());
  const Pose palm = handAt(m.hand, AxisPosition(6)).linkPose(m.hand.palm_link);
  const Capsule& hollow = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                        [](const Capsule& c) { return c.name == "hollow"; });
  const Eigen::Vector3d at = hollow.a_m - Eigen::Vector3d(0, 0, 0.03 + hollow.radius_m - 0.002);
  const SceneModel scene = weightless({ball(palm * at, 0.03, 0.1)});
  BodyState state;
  state.position_m = Vec3::from(scene.bodies[0].pose.translation_m);
  const auto found = PalmDistance(m.hand, scene)(palm, &state, 1U);
  EXPECT_LT(found.any_m, -1e-3);
  EXPECT_EQ(found.target_m, 0.0);
}

}  // namespace
}  // namespace wholehand::test
