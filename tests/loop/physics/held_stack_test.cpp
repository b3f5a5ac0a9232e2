// Two bodies of very different masses, one on the other, are lifted by the hand and held, through
// the whole renderer.
#include "loop/physics/body_yard.hpp"
#include "loop/physics/power_grasp.hpp"
#include "support/tolerance.hpp"

#include <fmt/format.h>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kRadius_m = 0.025, kBar_m = 0.12, kTop_m = 0.02, kFriction = 0.8;
constexpr int kGrasped = 6000;  // ticks until the grasp has settled
constexpr int kLifted = 12000;

/// A person who grasps an upright bar with a disc on it and lifts both from a table.
struct HeldStack : PowerGrasp {
  HeldStack(double bar_kg, double disc_kg)
      : PowerGrasp(
            8.0, bodies(bar_kg, disc_kg), [this](int read) { return script(read); },
            kGravity_m_s2) {}
  static std::vector<SceneBody> bodies(double bar_kg, double disc_kg) {
    const Vector3d bar_m(0.024 + kRadius_m, 0.041, 0.004);
    SceneBody table = ground(kFriction, 1.0);
    table.pose.translation_m += bar_m - 0.5 * kBar_m * Vector3d::UnitZ();
    const auto on_axis = [&](double length_m, double up_m, double mass_kg) {
      return bodyOf(roundShape(ShapeType::kCylinder, kRadius_m, length_m),
                    bar_m + up_m * Vector3d::UnitZ(), mass_kg, kFriction);
    };
    return {on_axis(kBar_m, 0.0, bar_kg), on_axis(kTop_m, 0.5 * (kBar_m + kTop_m), disc_kg), table};
  }
  AxisPosition script(int read) {
    if (read < kGrasped) grasp(read);
    if (read >= kGrasped) q_m[2] = 0.08 * std::min(1.0, (read - kGrasped) / 4000.0);
    return q_m;
  }
};

class LightAndHeavy : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(LightAndHeavy, LiftedTogether_RestInTheHand) {
  const auto [bar_kg, disc_kg] = GetParam();
  HeldStack hand(bar_kg, disc_kg);
  ASSERT_TRUE(hand.rig->renderer->arm());
  std::array<Vector3d, 2> from{};
  double moved_m = 0.0, fastest_m_s = 0.0, off_n = 0.0, least_m = kInfinity;
  ArticulatedBody body(hand.rig->models.hand);
  const double weight_n = (bar_kg + disc_kg) * kGravity_m_s2;
  runTicks(*hand.rig->renderer, kLifted + cases(10) * 1000, [&](const TickRecord& r) {
    hand.coupling = r.coupling;
    ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone) << "tick " << r.tick;
    if (r.tick < kLifted) return;
    body.updateKinematics(r.theta);
    const Pose palm = body.linkPose(0).inverse();
    for (int i = 0; i < 2; ++i) {
      const Vector3d at_m = palm * r.bodies[i].position_m.eigen();
      if (r.tick == kLifted) from[i] = at_m;
      moved_m = std::max(moved_m, (at_m - from[i]).norm());
      fastest_m_s = std::max(fastest_m_s, r.bodies[i].velocity_m_s.eigen().norm());
    }
    least_m = std::min(least_m, r.bodies[0].position_m.z - 0.004);
    off_n = std::max(
        off_n, std::abs(std::abs(virtualWork(hand.rig->models.hand, r.q_s, r)[2]) - weight_n));
  });
  const std::string name =
      fmt::format("{:g} g on {:g} g in the hand, ", 1e3 * disc_kg, 1e3 * bar_kg);
  figure(name + "lifted", 1e3 * least_m, "mm");
  figure(name + "slip", 1e3 * moved_m, "mm");
  figure(name + "fastest", 1e3 * fastest_m_s, "mm/s");
  figure(name + "weight in the hand, worst", off_n, "N off");
  EXPECT_GT(least_m, 0.01);
  EXPECT_LE(moved_m, 1e-4);
  EXPECT_LE(fastest_m_s, 1e-3);
  EXPECT_LE(off_n, 0.01 * weight_n);
}
INSTANTIATE_TEST_SUITE_P(Masses, LightAndHeavy,
                         testing::Values(std::pair{0.2, 2e-4}, std::pair{2e-4, 0.2}));

}  // namespace
}  // namespace wholehand::test
