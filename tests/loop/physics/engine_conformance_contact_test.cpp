// Contact laws that every engine satisfies: fixed contact, virtual work, friction cone, grasp.
#include "experiments/grasp_trial.hpp"
#include "loop/physics/engine_bench.hpp"
#include "support/seed.hpp"

#include <cmath>
#include <tuple>

namespace wholehand::test {
namespace {

WHOLEHAND_ENGINES(FixedContact);
WHOLEHAND_ENGINES_OF_CONTACT_LAWS(PressedContact);
WHOLEHAND_ENGINES_OF_CONTACT_LAWS(Grasp);
WHOLEHAND_ENGINES(FrictionCone);

TEST_P(FrictionCone, GraspThatSlidesAndSticks_StaysInItsCone) {
  Models m = load(shippedFiles("lambda-pride", "table"));
  m.scene.hand_friction = 0.2;
  AxisPosition above(6), down(6);
  above[2] = down[2] = 0.11;
  above[0] = -0.08;
  down[0] = 0.03;
  down[2] = -0.02;
  down[3] = 2.0;
  down[5] = 1.0;
  const auto rig = buildScripted(m, moveAndHold(above, down, 900), with(GetParam()));
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
  EXPECT_GT(sliding, 10);      // the bound was reached
  EXPECT_LT(sliding, points);  // and it also stuck
  figure("largest tangential over allowed friction force", worst, "");
  EXPECT_LE(worst, 1.0 + tolerance(boundsOf(GetParam()).beyond_cone));
}

/// Generalised forces on the hand's axes: contacts with bodies and of the hand with itself, and
/// joint ends.
AxisEffort acting(Bench& bench) {
  AxisEffort sum(bench.asked.size());
  std::array<double, kMaxAxes> row{};
  const auto add = [&](int link, const Vec3& at_m, const Vec3& force_n, double sign) {
    bench.body.reducedPointRow(link, at_m.eigen(), force_n.eigen(), row.data());
    for (int a = 0; a < sum.size(); ++a) sum[a] += sign * row[a];
  };
  for (int i = 0; i < bench.touching.count; ++i) {
    const Contact& c = bench.touching.points[i];
    add(c.link, c.point_m, c.force_n, 1.0);
    bench.body.reducedAngularRow(c.link, c.torque_nm.eigen(), row.data());
    for (int a = 0; a < sum.size(); ++a) sum[a] += row[a];
  }
  SelfForces own;
  bench.world->selfForces(own);
  const std::vector<Capsule>& capsules = bench.models.hand.capsules;
  for (int i = 0; i < own.count; ++i) {
    const SelfForce& touch = own.touches[i];
    add(capsules[touch.capsule_a].link, touch.point_m, touch.force_n, 1);
    add(capsules[touch.capsule_b].link, touch.point_m, touch.force_n, -1);
  }
  for (int a = 0; a < own.joint_ends.size(); ++a) sum[a] += own.joint_ends[a];
  return sum;
}

/// A fixed cylinder in the hollow of the hand, which closes on it and holds it.
SceneModel cylinderInHand() {
  SceneBody bottle = ball({0.049, 0.041, 0.004}, 0.025, 0.0);
  bottle.shapes[0].type = ShapeType::kCylinder;
  bottle.shapes[0].length_m = 0.2;
  return weightless({bottle});
}

/// Target of the hand: it moves to the cylinder, closes on it and presses.
struct Closing {
  AxisPosition open{6}, closed{6};
  Closing() {
    open[1] = -0.1, open[3] = closed[4] = 1.1;
    closed[3] = 2.0, closed[5] = 1.0;
  }
  [[nodiscard]] AxisPosition operator()(int step) const {
    AxisPosition q = open;
    q[1] = -0.1 * std::max(0.0, 1.0 - step / 700.0);
    const double u = std::clamp((step - 800) / 700.0, 0.0, 1.0);
    for (const int a : {3, 4, 5}) q[a] += u * (closed[a] - open[a]);
    return q;
  }
};

TEST_P(FixedContact, HeldByAClosedHand_DoesTheDrivesVirtualWork) {
  Bench bench(GetParam(), cylinderInHand());
  const Closing closing;
  ASSERT_TRUE(bench.world->placeHand(closing.open));
  double force_n = 0.0, torque_nm = 0.0, coupling_rad = 0.0;
  int touched = 0;
  for (int k = 0; k < 4000; ++k) {
    ASSERT_NO_FATAL_FAILURE(bench.step(closing(k), AxisVelocity(6)));
    coupling_rad = std::max(coupling_rad, bench.after.coupling_error_rad);
    if (k < 3500) continue;
    // M_r Δq̇_s = T (f_s + Σ Gᵀ Jᵀ f) holds in every step, at rest or in motion.
    const AxisEffort felt = acting(bench);
    const Eigen::VectorXd change =
        bench.body.reducedInertia() * (bench.after.qd_s.vec() - bench.state.qd_s.vec()) / kPeriod_s;
    const Eigen::VectorXd left = felt.vec() + bench.asked.vec() - change;
    force_n = std::max(force_n, left.head<3>().cwiseAbs().maxCoeff());
    // An engine may apply the force in the middle of an overlap, half of it away from the surface.
    double lever_nm = 0.0;
    for (int i = 0; i < bench.touching.count; ++i) {
      const Contact& c = bench.touching.points[i];
      lever_nm += 0.5 * std::abs(c.distance_m) * c.force_n.eigen().norm();
    }
    torque_nm = std::max(torque_nm, left.tail<3>().cwiseAbs().maxCoeff() - lever_nm);
    touched += bench.touching.count > 1 ? 1 : 0;
  }
  EXPECT_GT(touched, 450);
  EXPECT_GT(bench.asked.vec().tail<3>().cwiseAbs().maxCoeff(), 0.02) << "it does squeeze";
  figure("virtual work of contacts against the drive, worst, " + GetParam(), force_n, "N");
  figure("virtual work of contacts against the drive, beyond half an overlap, " + GetParam(),
         torque_nm, "N m");
  figure("coupling error before correction, " + GetParam(), coupling_rad, "rad");
  const Bounds& bounds = boundsOf(GetParam());
  EXPECT_LE(force_n, tolerance(bounds.virtual_work_n));
  EXPECT_LE(torque_nm, tolerance(bounds.virtual_work_nm));
  EXPECT_LE(coupling_rad, tolerance(bounds.synergy_rad));
}

/// Engines in which a contact's force reaches the axes within the step.
class HeavierHand : public EngineTest {};
INSTANTIATE_TEST_SUITE_P(Engines, HeavierHand, testing::ValuesIn([] {
                           std::vector<std::string> names = builtEngines();
                           std::erase(names, "bullet-paper");
                           return names;
                         }()),
                         [](const auto& one) { return testName(one.param); });

// τ = M G a + h with a = M_r⁻¹ f_s and M_r = Gᵀ M G + A, so that Gᵀ τ = f_s + h_r − A a. An engine
// with the armature A adds A a, so that at rest the contacts carry −f_s. An engine without it
// leaves −(f_s − A a) to the contacts: the share of A is missing for as long as the hand presses.
TEST_P(HeavierHand, HeldAtRest_PressesWithTheDriveLessAnyMissingArmaturesShare) {
  Bench bench(GetParam(), cylinderInHand());
  const Closing closing;
  constexpr double kShare = 4.0;  // share of M_r: A takes about four fifths of f_s
  ASSERT_NO_FATAL_FAILURE(bench.addArmature(kShare, closing.open));
  ASSERT_TRUE(bench.world->placeHand(closing.open));
  Eigen::VectorXd left = Eigen::VectorXd::Zero(6), asked = left, taken = left;
  constexpr int kSteps = 500;
  for (int k = 0; k < 4000; ++k) {
    ASSERT_NO_FATAL_FAILURE(bench.step(closing(k), AxisVelocity(6)));
    if (k < 4000 - kSteps) continue;
    const AxisEffort lacking = bench.body.armatureEffort(bench.asked);
    asked += bench.asked.vec() / kSteps;
    taken += lacking.vec() / kSteps;
    left += (acting(bench).vec() + bench.asked.vec()) / kSteps;
    if (!boundsOf(GetParam()).armature) left -= lacking.vec() / kSteps;
  }
  const double least = 0.02;  // N m
  ASSERT_GT(asked.tail<3>().cwiseAbs().maxCoeff(), least) << "it does squeeze";
  ASSERT_GT(taken.tail<3>().cwiseAbs().maxCoeff(), 0.5 * asked.tail<3>().cwiseAbs().maxCoeff())
      << "the two cases differ";
  figure("contacts at rest against the drive, armature considered, " + GetParam(),
         left.cwiseAbs().maxCoeff(), "N or N m");
  EXPECT_LE(left.cwiseAbs().maxCoeff(), tolerance(2e-5));
}

TEST_P(PressedContact, FixedWall_CarriesTheRequestedForceAtItsSurface) {
  // The wall's face is 1 cm from the hand, whose target is 1 cm behind the face.
  const Models m = load(shippedFiles());
  const double face_m = reach(m.hand, AxisPosition(6), Eigen::Vector3d::UnitY()) + 0.01;
  Bench bench(GetParam(), weightless({wall(Eigen::Vector3d::UnitY(), face_m)}));
  AxisPosition q(6);
  ASSERT_TRUE(bench.world->placeHand(q));
  for (int k = 0; k < 1500; ++k) {
    q[1] = 0.02 * std::min(1.0, k / 500.0);
    ASSERT_NO_FATAL_FAILURE(bench.step(q, AxisVelocity(6)));
  }
  double push_n = 0.0;
  for (int i = 0; i < bench.touching.count; ++i) {
    const Contact& c = bench.touching.points[i];
    push_n -= c.force_n.y;
    EXPECT_LT(c.normal.y, -0.99) << "from the body to the hand";
    EXPECT_EQ(c.body, 0);
    EXPECT_EQ(c.link, m.hand.capsules[c.capsule].link);
    EXPECT_NEAR(c.point_m.y, face_m, 1e-4) << "on the hand's surface, which is at the wall's";
  }
  // M_yy 4000 s⁻² 1 cm, with the hand at rest.
  const double asked_n = bench.body.reducedInertia()(1, 1) * 4e3 * (q[1] - bench.after.q_s[1]);
  EXPECT_GT(asked_n, 5.0);
  figure("pressed into a wall, carried over asked, " + GetParam(), push_n / asked_n, "");
  const Bounds& bounds = boundsOf(GetParam());
  EXPECT_NEAR(push_n, asked_n, tolerance(bounds.carried_share) * asked_n);
  const double gap_m = face_m - reach(m.hand, bench.after.q_s, Eigen::Vector3d::UnitY());
  figure("pressed into a wall, depth, " + GetParam(), -gap_m * 1e6, "um");
  EXPECT_NEAR(gap_m, 0.0, tolerance(bounds.surface_m));
}

TEST_P(Grasp, EveryTunedTrial_HoldsItsObject) {
  const Bounds& bounds = boundsOf(GetParam());
  double slip_m = 0.0, coupling_rad = 0.0, residual = 0.0, noise_n = 0.0;
  int held = 0, dropped = 0;
  std::size_t index = 0;
  for (const GraspTrial& trial : tunedTrials()) {
    if (leftOutUnderASanitizer(index++)) continue;
    GraspPlan plan;
    plan.setup.folder = testing::TempDir();
    plan.hold_s = 10.0;
    plan.setup.rig = with(GetParam());
    const GraspResult r = orThrow(runGrasp(trial, shippedFiles(), plan));
    coupling_rad = std::max(coupling_rad, r.coupling_error_rad);
    if (r.dropped) {
      std::printf("dropped: %s\n", trial.name().c_str());
      ++dropped;
      continue;
    }
    ++held;
    EXPECT_GT(r.object_travel_m, 0.15) << trial.name();
    slip_m = std::max(slip_m, r.slip_m);
    residual = std::max(residual, r.contact_residual);
    noise_n = std::max(noise_n, r.force_noise_n);
  }
  figure("tuned grasps held, " + GetParam(), held,
         ("of " + std::to_string(held + dropped)).c_str());
  figure("slip over a hold of 10 s, worst tuned grasp, " + GetParam(), slip_m * 1e3, "mm");
  figure("felt-force noise, worst tuned grasp, " + GetParam(), noise_n, "N");
  figure("contact forces against reduced effort, worst tuned grasp, " + GetParam(),
         residual * 100.0, "%");
  figure("coupling error, worst tuned grasp, " + GetParam(), coupling_rad, "rad");
  EXPECT_GT(held, 0);
  EXPECT_LE(dropped, 12 - bounds.grasps_held);
  EXPECT_LE(slip_m, tolerance(bounds.slip_m));
  EXPECT_LE(coupling_rad, tolerance(bounds.synergy_rad));
  EXPECT_LE(residual, tolerance(bounds.grasp_residual));
}

/// Pushes along one axis of the device at its speed limit, far beyond a fixed box.
class EngineSlam : public testing::TestWithParam<std::tuple<std::string, int>> {};

TEST_P(EngineSlam, IntoAFixedBoxAtTheSpeedLimit_DoesNotEnterIt) {
  const auto& [engine, axis] = GetParam();
  Models m = load(shippedFiles());
  const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
  AxisPosition start(6);
  start[axis] = m.device.axes[axis].lower;
  const double face_m = reach(m.hand, start, along) + 0.04;
  m.scene.bodies = {wall(along, face_m)};
  const double speed = m.device.axes[axis].speed_limit;
  const double far = m.device.axes[axis].upper;
  const auto rig = buildScripted(
      m,
      [=, axis = axis](int read) {
        AxisPosition q = start;
        q[axis] = std::min(start[axis] + speed * kPeriod_s * read, far);
        q[3] = std::min(10.0 * kPeriod_s * read, 1.0);  // fingers also close at their speed limit
        return q;
      },
      with(engine));
  ASSERT_TRUE(rig->renderer->arm());
  double before_m = -1.0, depth_m = -1.0, deepest_m = -1.0, stride_m = 0.0;
  const auto last = runTicks(*rig->renderer, 1500, [&](const TickRecord& r) {
    depth_m = reach(rig->models.hand, r.q_s, along) - face_m;
    if (r.tick > 0) stride_m = std::max(stride_m, depth_m - before_m);
    before_m = depth_m;
    deepest_m = std::max(deepest_m, depth_m);
    ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone);
  });
  EXPECT_GT(last->q_m[axis] - last->q_s[axis], 0.01);  // the device continued
  figure("depth at the speed limit, axis " + m.device.axes[axis].name, deepest_m * 1e3, "mm");
  figure("depth afterwards, axis " + m.device.axes[axis].name, depth_m * 1e3, "mm");
  // A surface is detected at most one period's travel too late, and any overlap is pushed out
  // again.
  const Bounds& bounds = boundsOf(engine);
  EXPECT_LE(deepest_m, bounds.slam_strides * stride_m);
  EXPECT_LT(depth_m, bounds.slammed_m);
}
INSTANTIATE_TEST_SUITE_P(Engines, EngineSlam,
                         testing::Combine(testing::ValuesIn(enginesOfContactLaws()),
                                          testing::Values(0, 1, 2)),
                         [](const auto& one) {
                           return testName(std::get<0>(one.param)) + "_" +
                                  std::to_string(std::get<1>(one.param));
                         });

}  // namespace
}  // namespace wholehand::test
