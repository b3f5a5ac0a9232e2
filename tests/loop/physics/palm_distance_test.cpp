// Distance of the palm from bodies.
#include "loop/physics/engine_bench.hpp"
#include "loop/physics/hand_probe.hpp"
#include "support/tolerance.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

TEST(PalmDistance, BallsAndBoxes_MatchTheClosedForm) {
  const Models m = load(shippedFiles());
  AxisPosition q(6);
  q[0] = 0.02, q[1] = -0.03, q[2] = 0.04;
  const ArticulatedBody at = handAt(m.hand, q);
  const Capsule& hollow = *std::find_if(m.hand.capsules.begin(), m.hand.capsules.end(),
                                        [](const Capsule& c) { return c.name == "hollow"; });
  const Pose& palm = at.linkPose(m.hand.palm_link);
  const Eigen::Vector3d a = palm * hollow.a_m, b = palm * hollow.b_m;
  const auto distance = [&](const SceneBody& body) {
    Bench bench(defaultEngine(), weightless({body}));
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
  // A wide box above: the distance from the higher end to its face.
  const double top = std::max(a.z(), b.z());
  EXPECT_NEAR(distance(fixedBox({0.0, 0.0, top + 0.2}, {1.0, 1.0, 0.1})),
              0.2 - 0.05 - hollow.radius_m, tolerance(1e-5));
  // No body: an infinite distance.
  Bench empty(defaultEngine(), weightless({}));
  ASSERT_TRUE(empty.world->placeHand(q));
  EXPECT_EQ(empty.ask({}).palm_distance_m, std::numeric_limits<double>::infinity());
}

/// A ball near the middle of the palm's hollow, which faces -z of the palm's frame. Its distance is
/// that of the segment between the hollow's ends, less both radii.
TEST(PalmDistance, Target_IsNegativeUnlessItIsInFrontOfThePalm) {
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

TEST(PalmDistance, TargetThatTouchesThePalm_IsNeverNegative) {
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

TEST(PalmTarget, SeveralTargets_GiveTheNearest) {
  Bench bench(defaultEngine(),
              weightless({ball({0.1, 0.09, 0.0}, 0.02, 0.0), ball({0.1, 0.2, 0.0}, 0.02, 0.0),
                          ball({0.1, 0.15, 0.05}, 0.02, 0.0)}));
  ASSERT_TRUE(bench.world->placeHand(AxisPosition(6)));
  std::array<double, 3> alone_m{};
  for (int b = 0; b < 3; ++b) {
    const TickRecord s = bench.ask({1U << b, -1});
    EXPECT_EQ(s.palm_body, b);
    alone_m[b] = s.palm_target_distance_m;
    EXPECT_EQ(s.palm_distance_m, bench.ask({}).palm_distance_m);
  }
  EXPECT_EQ(alone_m[0], bench.ask({}).palm_distance_m);  // the nearest of all
  const TickRecord far_two = bench.ask({0b110, -1});
  const int nearer = alone_m[1] < alone_m[2] ? 1 : 2;
  EXPECT_EQ(far_two.palm_body, nearer);
  EXPECT_EQ(far_two.palm_target_distance_m, std::min(alone_m[1], alone_m[2]));
  EXPECT_EQ(far_two.palm_distance_m, alone_m[0]);
  const TickRecord none = bench.ask({});
  EXPECT_EQ(none.palm_body, -1);
  EXPECT_EQ(none.palm_target_distance_m, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace wholehand::test
