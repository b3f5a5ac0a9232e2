// A fixed upright bottle is held in the power grasp as at the bar, through the whole renderer.
// Checks the squeeze, the thumb, the backs of the fingers and the first touch.
#include "loop/physics/power_grasp.hpp"
#include "support/tolerance.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

SceneBody bottle(const Eigen::Vector3d& at_m) {
  SceneBody body = ball(at_m, 0.025, 0.0);
  body.name = "bottle";
  body.shapes[0].type = ShapeType::kCylinder;
  body.shapes[0].length_m = 0.2;
  return body;
}

/// Places the bottle where the power grasp needs it relative to the base of the hand.
struct BarGrasp : PowerGrasp {
  BarGrasp(double effort_tip_n, double aside_m)
      : PowerGrasp(effort_tip_n, bottle({0.049, 0.041 + aside_m, 0.004}), [this](int read) {
          grasp(read);
          return q_m;
        }) {}
};

/// The grasp has settled from this tick on; before it a finger may slip once by a small amount.
constexpr int kHeld = 8000;

class Squeeze : public testing::TestWithParam<double> {};

TEST_P(Squeeze, FixedBottle_IsSteadyShallowAndByThumbAndFingers) {
  BarGrasp grasp(GetParam(), 0.0);
  ASSERT_TRUE(grasp.rig->renderer->arm());
  double sum_n = 0.0, squares_n2 = 0.0, thumb_n = 0.0, fingers_n = 0.0, deepest_m = 0.0;
  int counted = 0;
  const auto last = runTicks(*grasp.rig->renderer, kHeld + 1000, [&](const TickRecord& r) {
    grasp.coupling = r.coupling;
    ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone)
        << "axis " << r.fault_axis << " at " << r.q_m[std::max(r.fault_axis, 0)] << " tick "
        << r.tick;
    double now_n = 0.0;
    for (int i = 0; i < r.contact_count; ++i) {
      const Contact& c = r.contacts[i];
      deepest_m = std::max(deepest_m, -c.distance_m);
      const double normal_n = c.force_n.eigen().dot(c.normal.eigen());
      now_n += normal_n;
      if (r.tick < kHeld) continue;
      const HandPart part = grasp.rig->models.hand.capsules[c.capsule].part;
      (part == HandPart::kThumb ? thumb_n : fingers_n) += 1e-3 * normal_n;
    }
    if (r.tick < kHeld) return;
    ++counted;
    sum_n += now_n;
    squares_n2 += now_n * now_n;
  });
  const double mean_n = sum_n / counted;
  const double noise_n = std::sqrt(std::max(0.0, squares_n2 / counted - mean_n * mean_n));
  const std::string name = "squeeze at " + std::to_string(static_cast<int>(GetParam())) + " N, ";
  figure(name + "sum of normal forces", mean_n, "N");
  figure(name + "of it the thumb", thumb_n, "N");
  figure(name + "noise", noise_n, "N");
  figure(name + "deepest overlap", deepest_m * 1e3, "mm");
  EXPECT_NEAR(-last->coupling[kFingers] / kLever_m, GetParam(), 0.05 * GetParam());
  EXPECT_LE(noise_n, tolerance(0.005));
  EXPECT_LE(deepest_m, 1.5e-3);
  EXPECT_GT(thumb_n, 0.2 * GetParam());
  EXPECT_GT(fingers_n, GetParam());
  // The rendered effort of every axis equals the virtual work of the contact forces on the bottle.
  EXPECT_GT(mean_n, 1.5 * GetParam());
  const AxisEffort work = virtualWork(grasp.rig->models.hand, last->q_s, *last);
  for (int a = 0; a < work.size(); ++a) {
    EXPECT_NEAR(last->coupling[a], work[a], tolerance(0.02) * std::abs(work[a]) + 1e-4) << a;
  }
}
INSTANTIATE_TEST_SUITE_P(Efforts, Squeeze, testing::Values(1.0, 4.0, 10.0));

TEST(FirstTouchInAGrasp, RestingFingers_AreAtTheirFirstTouch) {
  BarGrasp grasp(2.0, 0.0);
  ASSERT_TRUE(grasp.rig->renderer->arm());
  const auto last = runTicks(*grasp.rig->renderer, 5000,
                             [&](const TickRecord& r) { grasp.coupling = r.coupling; });
  ASSERT_GT(last->contact_count, 1);
  const Models& models = grasp.rig->models;
  HandProbe probe(models.hand, models.scene);
  ArticulatedBody body(models.hand);
  TickRecord state = *last;
  body.updateKinematics(state.theta);
  for (int k = 0; k < 50; ++k) probe.look(&body.linkPose(0), {1, 0}, state);
  // A finger that rests on the bottle has its first touch where it is, except for the 10 µm
  // compliance of contacts, which a finger that closes along the surface sees enlarged.
  EXPECT_LE(state.closure[kFingers], state.q_s[kFingers] + 1e-6);
  EXPECT_GE(state.closure[kFingers], state.q_s[kFingers] - 5e-3);
  // The bottle pushes the thumb beyond its open end, so they overlap there.
  EXPECT_LT(state.q_s[kThumb], 0.0);
  EXPECT_EQ(state.closure[kThumb], -std::numeric_limits<double>::infinity());
  EXPECT_EQ(state.palm_body, 0);
}

TEST(BackOfTheFingers, BumpingTheBottle_IsRendered) {
  Models m = load(shippedFiles());
  m.scene.bodies = {bottle({0.119, -0.06, 0.004})};  // beside the fingers, behind their backs
  const auto rig = buildScripted(std::move(m), [](int read) {
    AxisPosition q(6);
    q[1] = -1e-4 * std::min(read, 500);  // 0.1 m/s to the right, 5 cm
    return q;
  });
  ASSERT_TRUE(rig->renderer->arm());
  double felt_n = 0.0, deepest_m = 0.0;
  bool by_fingers = false;
  runTicks(*rig->renderer, 700, [&](const TickRecord& r) {
    felt_n = std::max(felt_n, r.coupling[1]);
    for (int i = 0; i < r.contact_count; ++i) {
      const HandPart part = rig->models.hand.capsules[r.contacts[i].capsule].part;
      by_fingers = by_fingers || (part != HandPart::kPalm && part != HandPart::kThumb);
      deepest_m = std::max(deepest_m, -r.contacts[i].distance_m);
    }
  });
  figure("bump with the back of the fingers, felt", felt_n, "N");
  EXPECT_TRUE(by_fingers);
  EXPECT_GT(felt_n, 2.0);  // 1 N per mm that the hand is held back, which is some centimetres
  EXPECT_LE(deepest_m, 1.5e-3);
}

}  // namespace
}  // namespace wholehand::test
