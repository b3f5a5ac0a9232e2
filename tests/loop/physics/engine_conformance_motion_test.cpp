// Motion laws that every engine satisfies: free hands and bodies, momentum, friction, rest.
#include "loop/physics/engine_bench.hpp"
#include "support/tolerance.hpp"

#include <cmath>
#include <random>

namespace wholehand::test {
namespace {

WHOLEHAND_ENGINES(FreeHand);
WHOLEHAND_ENGINES(FreeBodies);
WHOLEHAND_ENGINES(BodiesOnASlab);
WHOLEHAND_ENGINES(TableScene);
WHOLEHAND_ENGINES(LeftHand);

TEST_P(FreeHand, UnderRandomEffort_FollowsItsReducedInertia) {
  Models m = load(shippedFiles());
  // Widens the joints' ranges: a walk of random efforts leaves them, and their ends would stop it.
  m.hand.self_contacts.clear();
  for (HandLink& link : m.hand.links) link.lower = -10.0, link.upper = 10.0;
  const auto made = orThrow(buildWorld(GetParam(), m.hand, m.scene));
  PhysicsWorld& world = *made;
  ASSERT_TRUE(world.placeHand(m.hand.reference));
  ArticulatedBody body(m.hand);
  std::mt19937_64 random(3);
  const auto draw = [&] { return 2.0 * static_cast<double>(random() >> 11U) * 0x1.0p-53 - 1.0; };
  double worst = 0.0;
  for (int k = 0; k < 500; ++k) {
    const PhysicsState s = look(world);
    ASSERT_TRUE(body.update(s.theta, s.theta_dot, m.scene.gravity_m_s2));
    for (int l = 0; s.kinematics != nullptr && l < static_cast<int>(m.hand.links.size()); ++l) {
      ASSERT_EQ(s.kinematics->linkPose(l).rotation, body.linkPose(l).rotation) << "step " << k;
      ASSERT_EQ(s.kinematics->linkPose(l).translation_m, body.linkPose(l).translation_m);
    }
    AxisEffort f_s(m.hand.axis_count);
    for (int a = 0; a < f_s.size(); ++a) f_s[a] = draw() * 20.0 * body.reducedInertia()(a, a);
    HandDrive drive;
    drive.effort = f_s;
    body.distribute(f_s, drive.torque);
    drive.reduced_inertia_inverse = &body.reducedInertiaInverse();
    ASSERT_EQ(world.step(drive, kPeriod_s) & kStoppingFaults, Fault::kNone);
    const PhysicsState next = look(world);
    // q̈ = M_r⁻¹ f_s: h carries gravity and all velocity terms. Symplectic Euler.
    const Eigen::VectorXd rate =
        s.qd_s.vec() + kPeriod_s * body.reducedInertiaInverse() * f_s.vec();
    const Eigen::VectorXd place = s.q_s.vec() + kPeriod_s * rate;
    worst = std::max({worst, (next.qd_s.vec() - rate).cwiseAbs().maxCoeff(),
                      (next.q_s.vec() - place).cwiseAbs().maxCoeff()});
  }
  figure("free hand against M_r^-1 f_s, worst change of velocity", worst, "m/s or rad/s");
  EXPECT_LE(worst, tolerance(boundsOf(GetParam()).free_motion));
}

/// Mirror image in y, in the device's coordinates.
AxisPosition mirrored(AxisPosition q) {
  q[1] = -q[1];
  return q;
}

/// Target that swings sideways into a body there while the fingers close.
AxisPosition swing(double t, double sign) {
  AxisPosition q(6);
  q[1] = sign * 0.06 * std::sin(4.0 * t);
  q[0] = 0.01 * std::sin(3.0 * t);
  q[3] = 0.8 + 0.6 * std::sin(2.0 * t);
  q[4] = 0.6;
  q[5] = 0.3;
  return q;
}

TEST_P(FreeBodies, PushedByTheHand_ChangeTheirMomentumByMinusTheContactForces) {
  // The hand pushes one ball, which pushes the other; the forces between the balls cancel.
  Bench bench(GetParam(), weightless({ball({0.09, 0.075, 0.0}, 0.03, 0.1),
                                      ball({0.095, 0.142, 0.0}, 0.03, 0.2)}));
  ASSERT_TRUE(bench.world->placeHand(swing(0.0, 1.0)));
  const auto momentum = [](const PhysicsState& s) -> Eigen::Vector3d {
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
  EXPECT_GT(bench.after.bodies[1].velocity_m_s.eigen().norm(), 0.01);  // the second ball was hit
  figure("momentum of pushed balls against the contact forces", worst, "N s");
  EXPECT_LE(worst, tolerance(boundsOf(GetParam()).momentum_ns));
}

/// Speed of a block down a fixed slab after 0.5 s, with gravity tilted by the slope [m/s].
double slidingSpeed(const std::string& engine, double slope_rad) {
  SceneBody block = fixedBox({0.0, 0.0, 0.3}, {0.1, 0.1, 0.02});
  block.name = "block";
  block.fixed = false;
  block.mass_kg = 0.2;
  block.inertia_kg_m2 =
      Eigen::Vector3d(1.7333e-4, 1.7333e-4, 3.3333e-4).asDiagonal();  // m (a² + b²) / 12
  SceneModel scene = weightless({fixedBox({0.0, 0.0, 0.28}, {3.0, 0.5, 0.02}), block});
  scene.gravity_m_s2 = 9.81 * Eigen::Vector3d(std::sin(slope_rad), 0.0, -std::cos(slope_rad));
  Bench bench(engine, scene);
  const AxisPosition far_below(6);
  EXPECT_TRUE(bench.world->placeHand(far_below));
  for (int k = 0; k < 500; ++k) bench.step(far_below, AxisVelocity(6));
  return bench.after.bodies[1].velocity_m_s.x;
}

TEST_P(BodiesOnASlab, SlideAndStayByCoulombsFriction) {
  // μ = 0.8 on both. Below tan α = 0.8 the block stays; above it slides with g (sin α − μ cos α).
  EXPECT_NEAR(slidingSpeed(GetParam(), std::atan(0.7)), 0.0, tolerance(1e-4));
  const double steep = std::atan(1.2);
  const double expected = 0.5 * 9.81 * (std::sin(steep) - 0.8 * std::cos(steep));
  EXPECT_NEAR(slidingSpeed(GetParam(), steep), expected,
              tolerance(boundsOf(GetParam()).sliding_share) * expected);
}

TEST_P(TableScene, LeftAlone_StandsStill) {
  const Models m = load(shippedFiles("lambda-pride", "table"));
  Bench bench(GetParam(), m.scene);
  AxisPosition clear(6);
  clear[0] = -0.08, clear[2] = 0.11;
  ASSERT_TRUE(bench.world->placeHand(clear));
  const PhysicsState before = look(*bench.world);
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
  const Bounds& bounds = boundsOf(GetParam());
  EXPECT_LE(moved_m, tolerance(bounds.moved_at_rest_m));
  EXPECT_LE(turned_rad, tolerance(bounds.turned_at_rest_rad));
}

TEST_P(LeftHand, MirroredScene_GivesTheMirrorImage) {
  // Frictionless, so that the solver's choice of tangents does not matter.
  SceneBody right = ball({0.09, 0.075, 0.0}, 0.03, 0.1),
            left = ball({0.09, -0.075, 0.0}, 0.03, 0.1);
  right.friction = left.friction = 0.0;
  Bench r(GetParam(), weightless({right})), l(GetParam(), weightless({left}), "adult-median-left");
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
  EXPECT_LE(hand, tolerance(boundsOf(GetParam()).mirror));
  EXPECT_LE(body, tolerance(boundsOf(GetParam()).mirror));
}

}  // namespace
}  // namespace wholehand::test
