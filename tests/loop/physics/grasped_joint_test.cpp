// The hand opens bodies on a joint by their handles, through the whole renderer. The rendered
// effort is the virtual work of the joint's force, and the grasp does not slip.
#include "loop/physics/power_grasp.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace wholehand::test {
namespace {

constexpr double kTip_n = 8.0;
constexpr int kGrasped = 6000;  // ticks until the grasp has settled

/// A vertical bar where the power grasp needs it relative to the base of the hand.
SceneBody handleBar(double radius_m, double mass_kg, const SceneJoint& joint) {
  SceneBody body = ball({0.024 + radius_m, 0.041, 0.004}, radius_m, mass_kg);
  body.name = "handle";
  body.fixed = false;
  body.shapes[0].type = ShapeType::kCylinder;
  body.shapes[0].length_m = 0.12;
  const double across = mass_kg * (3.0 * radius_m * radius_m + 0.12 * 0.12) / 12.0;
  body.inertia_kg_m2 =
      Eigen::Vector3d(across, across, 0.5 * mass_kg * radius_m * radius_m).asDiagonal();
  body.joint = joint;
  return body;
}

/// A person who takes the bar, closes until kTip_n act at the tips and then moves the hand in that
/// posture.
struct PulledBar : PowerGrasp {
  std::function<Eigen::Vector3d(int)> way;  ///< motion of the hand, by ticks since kGrasped

  PulledBar(const SceneBody& bar, std::function<Eigen::Vector3d(int)> moves)
      : PowerGrasp(kTip_n, bar, [this](int read) { return script(read); }), way(std::move(moves)) {}
  AxisPosition script(int read) {
    if (read < kGrasped) grasp(read);
    if (read > kGrasped) {
      const Eigen::Vector3d to = way(read - kGrasped);
      for (int a = 0; a < 3; ++a) q_m[a] = to[a];
    }
    return q_m;
  }
  template <class Observe>
  std::unique_ptr<TickRecord> run(int ticks, const Observe& observe) {
    return runTicks(*rig->renderer, ticks, [&](const TickRecord& r) {
      coupling = r.coupling;
      ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone)
          << "axis " << r.fault_axis << ", tick " << r.tick;
      observe(r);
    });
  }
  /// The bar's centre in the palm's frame at a tick.
  [[nodiscard]] Eigen::Vector3d inPalm(const TickRecord& r) const {
    ArticulatedBody body(rig->models.hand);
    body.updateKinematics(r.theta);
    return body.linkPose(0).inverse() * r.bodies[0].position_m.eigen();
  }
};

SceneJoint drawerSlide() {
  SceneJoint joint;
  joint.type = SceneJoint::Type::kSlide;
  joint.axis = -Eigen::Vector3d::UnitX();
  joint.least = 0.0, joint.most = 0.12;
  joint.dry_friction = 2.0;
  return joint;
}

class Drawer : public testing::TestWithParam<double> {};

TEST_P(Drawer, PulledByItsHandle_FollowsTheHandAndRendersItsFriction) {
  const auto slowly = [](int k) {
    return Eigen::Vector3d(-0.05 * std::min(1.0, k / 2000.0), 0, 0);
  };
  PulledBar bar(handleBar(GetParam(), 1.0, drawerSlide()), slowly);
  ASSERT_TRUE(bar.rig->renderer->arm());
  double worst = 0.0, worst_felt = 0.0;
  int counted = 0;
  Eigen::Vector3d held = Eigen::Vector3d::Zero();
  const double start_x = bar.rig->models.scene.bodies[0].pose.translation_m.x();
  const auto last = bar.run(kGrasped + 2200, [&](const TickRecord& r) {
    const Eigen::Vector3d at = r.bodies[0].position_m.eigen();
    ASSERT_NEAR(at.y(), 0.041, 1e-15);
    ASSERT_NEAR(at.z(), 0.004, 1e-15);
    ASSERT_LE(at.x(), start_x + 1e-15);
    const AxisEffort work = virtualWork(bar.rig->models.hand, r.q_s, r);
    if (static_cast<int>(r.tick) == kGrasped + 500) held = bar.inPalm(r);
    // After friction has yielded, at a steady speed.
    if (static_cast<int>(r.tick) > kGrasped + 1300 && static_cast<int>(r.tick) < kGrasped + 1900) {
      worst = std::max(worst, std::abs(work[0] - 2.0));
      worst_felt = std::max(worst_felt, std::abs(r.coupling[0] - 2.0));
      ++counted;
    }
  });
  ASSERT_GT(counted, 500);
  figure("drawer of 2 N, virtual work of the contacts, worst", worst, "N off");
  figure("drawer of 2 N, felt, worst", worst_felt, "N off");
  figure("drawer, slip of the handle", 1e3 * (bar.inPalm(*last) - held).norm(), "mm");
  // At a steady speed the friction is rendered: 2 N away from the person.
  EXPECT_LE(worst, 0.02 * 2.0);
  EXPECT_LE(worst_felt, 0.02 * 2.0 + 0.05);
  EXPECT_GT(start_x - last->bodies[0].position_m.x, 0.03);
  EXPECT_LE((bar.inPalm(*last) - held).norm(), 1e-4);
}
INSTANTIATE_TEST_SUITE_P(Radii, Drawer,
                         testing::ValuesIn(sampleTenth<double>({0.0125, 0.015, 0.025})));

// Dry friction has one coefficient, so that nothing may stick again: a drawer that is pulled slowly
// moves as steadily as the hand.
TEST(SlowDrawer, PulledByItsHandle_DoesNotStickAndSlip) {
  for (const double speed_m_s : {1e-3, 5e-3}) {
    const auto slowly = [&](int k) { return Eigen::Vector3d(-1e-3 * speed_m_s * k, 0, 0); };
    PulledBar bar(handleBar(0.0125, 1.0, drawerSlide()), slowly);
    ASSERT_TRUE(bar.rig->renderer->arm());
    double least_m_s = kInfinity, most_m_s = 0.0, off_n = 0.0;
    // The device is 40 mm ahead before the coupling pulls with 2 N.
    const int yields = static_cast<int>(40.0 / speed_m_s), ticks = yields + 2000;
    bar.run(kGrasped + ticks, [&](const TickRecord& r) {
      if (static_cast<int>(r.tick) < kGrasped + yields) return;
      const double is_m_s = -r.bodies[0].velocity_m_s.x;
      least_m_s = std::min(least_m_s, is_m_s), most_m_s = std::max(most_m_s, is_m_s);
      off_n = std::max(off_n, std::abs(virtualWork(bar.rig->models.hand, r.q_s, r)[0] - 2.0));
    });
    const std::string name = fmt::format("drawer pulled at {} mm/s, ", 1e3 * speed_m_s);
    figure(name + "slowest", 1e3 * least_m_s, "mm/s");
    figure(name + "fastest", 1e3 * most_m_s, "mm/s");
    figure(name + "virtual work, worst", off_n, "N off");
    EXPECT_GE(least_m_s, 0.9 * speed_m_s);
    EXPECT_LE(most_m_s, 1.1 * speed_m_s);
    EXPECT_LE(off_n, 0.02 * 2.0);
  }
}

/// A handle that a spring pulls back with 5 N does not slip in the hand.
void holdAgainst5N(int seconds) {
  SceneJoint joint = drawerSlide();
  joint.dry_friction = 0.0;
  joint.spring_stiffness = 100.0;  // 5 N after 50 mm
  const auto out = [](int k) { return Eigen::Vector3d(-0.068 * std::min(1.0, k / 2000.0), 0, 0); };
  PulledBar bar(handleBar(0.0125, 1.0, joint), out);
  ASSERT_TRUE(bar.rig->renderer->arm());
  Eigen::Vector3d held = Eigen::Vector3d::Zero();
  double most_m = 0.0, force_n = 0.0;
  const int settled = kGrasped + 3000, ticks = settled + 1000 * seconds;
  bar.run(ticks, [&](const TickRecord& r) {
    const int tick = static_cast<int>(r.tick);
    if (tick == settled) held = bar.inPalm(r);
    if (tick <= settled || tick % 100 != 0) return;
    most_m = std::max(most_m, (bar.inPalm(r) - held).norm());
    force_n =
        100.0 * (bar.rig->models.scene.bodies[0].pose.translation_m.x() - r.bodies[0].position_m.x);
  });
  figure("handle held against a spring", force_n, "N");
  figure("handle held, slip", 1e3 * most_m, "mm");
  EXPECT_NEAR(force_n, 5.0, 0.6);
  EXPECT_LE(most_m, 1e-4);
}

TEST(SprungHandle, HeldFor60SAgainst5N_DoesNotSlip) {
  holdAgainst5N(std::min(60, cases(60)));
}

TEST(SprungHandle, HeldFor600SAgainst5N_DoesNotSlip_slow) {
  holdAgainst5N(600);
}

/// A bar on a random joint with spring, viscous and dry friction and a latch.
SceneBody anyBar(std::mt19937_64& random) {
  const auto between = [&](double low, double high) { return uniform(random, low, high); };
  const auto any = [&] { return Eigen::Vector3d(between(-1, 1), between(-1, 1), between(-1, 1)); };
  SceneJoint joint;
  joint.type = random() % 2 == 0 ? SceneJoint::Type::kHinge : SceneJoint::Type::kSlide;
  joint.axis = any().normalized();
  const double size = joint.isHinge() ? 0.01 : 1.0;  // converts N·m to N at about 100 mm
  if (joint.isHinge()) joint.point_m = between(0.05, 0.2) * any().normalized();
  joint.spring_stiffness = between(0.0, 100.0) * size;
  joint.spring_rest = between(-0.01, 0.01);
  joint.viscous_friction = between(0.0, 5.0) * size;
  joint.dry_friction = random() % 2 == 0 ? 0.0 : between(0.1, 2.0) * 10.0 * size;
  joint.latch_energy_j = between(0.0, 2e-3);
  joint.latch_wave = joint.isHinge() ? 8.0 : 2.0 * std::numbers::pi / 0.02;
  return handleBar(between(0.0125, 0.025), between(0.1, 2.0), joint);
}

/// Inertia m_q of a body on its joint, by its definition.
double momentOf(const SceneBody& body) {
  if (!body.joint->isHinge()) return body.mass_kg;
  const Eigen::Vector3d& axis = body.joint->axis;
  return axis.dot(body.inertia_kg_m2 * axis) +
         body.mass_kg * axis.cross(body.com_m - body.joint->point_m).squaredNorm();
}

// D'Alembert over one step: the impulse of the hand's contacts on q̇ is the change of momentum less
// the joint's forces as ADR 91 defines them for a touched joint (those of the potential at the
// step's start with its slope k, viscous friction at its end), less a dry friction of |λ| ≤ F_c T.
TEST(Contacts, OnAnyJoint_DoTheVirtualWorkOfItsForces) {
  std::mt19937_64 random(seed());
  double worst = 0.0, most = 0.0;
  int counted = 0, slid = 0;
  constexpr int kMostDraws = 300;  // a bar that swings away at once is not touched
  for (int k = 0; k < cases(10) || (counted <= 100 && k < kMostDraws); ++k) {
    const SceneBody bar = anyBar(random);
    const SceneJoint& joint = *bar.joint;
    PulledBar hand(bar, [](int) { return Eigen::Vector3d::Zero(); });
    ASSERT_TRUE(hand.rig->renderer->arm());
    const double period_s = hand.rig->renderer->config().period_s, inertia = momentOf(bar);
    const Eigen::Vector3d gravity_m_s2 = hand.rig->models.scene.gravity_m_s2;
    const double latch = 0.5 * joint.latch_energy_j * joint.latch_wave;
    double q = 0.0, rate = 0.0;
    TickRecord before;
    hand.run(2500, [&](const TickRecord& r) {
      const BodyState& now = r.bodies[0];
      const Pose at{now.orientation_xyzw.eigen().toRotationMatrix(), now.position_m.eigen()};
      // A pose tells a hinge's position but for whole turns.
      const double in_a_turn = positionOn(joint, bar.pose, at), turn = 2.0 * std::numbers::pi;
      const double turns = joint.isHinge() ? std::round((q - in_a_turn) / turn) : 0.0;
      const double next_q = in_a_turn + turn * turns;
      const Eigen::Vector3d axis = at.rotation * joint.axis;
      const double next_rate = joint.isHinge() ? axis.dot(now.angular_velocity_rad_s.eigen())
                                               : axis.dot(now.velocity_m_s.eigen());
      if (before.contact_count > 0) {
        const Pose then = poseOn(joint, bar.pose, q);
        const Eigen::Vector3d about = then.rotation * joint.axis, hinge_m = then * joint.point_m;
        const auto way = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
          return joint.isHinge() ? about.cross(p - hinge_m) : about;
        };
        double hand_does = 0.0;
        for (int i = 0; i < before.contact_count; ++i) {
          const Contact& c = before.contacts[i];
          const Eigen::Vector3d on_body = c.point_m.eigen() - c.distance_m * c.normal.eigen();
          hand_does -= c.force_n.eigen().dot(way(on_body));
          if (joint.isHinge()) hand_does -= c.torque_nm.eigen().dot(about);
        }
        const double phase = joint.latch_wave * q, step = period_s * next_rate;
        const Eigen::Vector3d com_way = way(then.translation_m);
        const bool hinge = joint.isHinge();
        const double curve = joint.spring_stiffness + latch * joint.latch_wave * std::cos(phase) -
                             (hinge ? bar.mass_kg * gravity_m_s2.dot(about.cross(com_way)) : 0.0);
        const double bend = latch * joint.latch_wave * joint.latch_wave +
                            (hinge ? bar.mass_kg * gravity_m_s2.norm() * com_way.norm() : 0.0);
        const double slope =
            std::max({0.0, curve, 0.5 * curve + period_s * bend * std::abs(rate) / 3.0});
        const double force = bar.mass_kg * gravity_m_s2.dot(com_way) - latch * std::sin(phase) -
                             joint.spring_stiffness * (q - joint.spring_rest) - slope * step -
                             joint.viscous_friction * next_rate;
        const double rest = inertia * (next_rate - rate) / period_s - force - hand_does;
        const double scale = std::abs(hand_does) + std::abs(force) + std::abs(latch);
        const double off = std::max(0.0, std::abs(rest) - joint.dry_friction) / scale;
        worst = std::max(worst, off);
        most = std::max(most, std::abs(hand_does));
        ++counted;
        if (joint.dry_friction > 0.0 && std::abs(next_rate) > 1e-6) ++slid;
      }
      before = r;
      q = next_q, rate = next_rate;
    });
  }
  figure("contacts on random joints, steps", counted, "");
  figure("of them slid against dry friction", slid, "");
  figure("virtual work of contacts and joint, worst", 100.0 * worst, "%");
  ASSERT_GT(counted, 100);
  EXPECT_GT(most, 1e-3);
  EXPECT_LE(worst, tolerance(1e-11));
}

/// A panel upright in x and z in front of the palm, on a hinge beyond the fingertips.
SceneBody panelBeforeThePalm(double spring_nm_rad) {
  SceneBody panel = fixedBox({0.12, 0.12, 0.0}, {0.24, 0.02, 0.2});
  panel.name = "panel";
  panel.fixed = false;
  panel.mass_kg = 1.5;
  const ShapeMoments moment = moments(panel.shapes[0]);
  panel.inertia_kg_m2 = panel.mass_kg / moment.volume_m3 * moment.inertia_m5;
  SceneJoint joint;
  joint.axis = Eigen::Vector3d::UnitZ();  // at +q it comes towards a right hand's palm
  joint.point_m = {0.12, 0.0, 0.0};
  joint.least = 0.0, joint.most = 1.2;
  joint.dry_friction = 0.02;
  joint.spring_stiffness = spring_nm_rad;
  joint.spring_rest = 1.5;
  panel.joint = joint;
  return panel;
}

// A door that somebody else shuts on the hand stops at the palm. The rendered effort is its torque
// over its lever, within the device's limit; no fault occurs and the hand does not enter it.
TEST(Panel, SwingingIntoThePalm_IsStoppedByTheHandAndRendered) {
  double hardest_n = 0.0, deepest_m = 0.0, fastest = 0.0;
  Models m = load(shippedFiles());
  m.scene.bodies = {panelBeforeThePalm(0.3)};
  const SceneBody panel = m.scene.bodies[0];
  AxisPosition still(6);
  still[kFingers] = 65.0 * kDeg, still[kCircumduction] = 5.0 * kDeg;
  const auto rig = buildScripted(std::move(m), [&](int) { return still; });
  ASSERT_TRUE(rig->renderer->arm());
  const auto last = runTicks(*rig->renderer, 6000, [&](const TickRecord& r) {
    ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone) << r.tick;
    hardest_n = std::max(hardest_n, std::abs(r.sent[1]));
    fastest = std::max(fastest, r.bodies[0].angular_velocity_rad_s.eigen().norm());
    for (int i = 0; i < r.contact_count; ++i) {
      deepest_m = std::max(deepest_m, -r.contacts[i].distance_m);
    }
  });
  figure("panel into the palm, arrives with", fastest, "rad/s");
  figure("panel into the palm, hardest", hardest_n, "N");
  figure("panel into the palm, deepest", 1e3 * deepest_m, "mm");
  EXPECT_GT(fastest, 0.5);
  EXPECT_LE(deepest_m, 0.5e-3);
  EXPECT_LE(hardest_n, last->effort_limit[1]);
  ASSERT_GT(last->contact_count, 0);
  EXPECT_LE(last->bodies[0].angular_velocity_rad_s.eigen().norm(), 1e-3);
  // At rest the hand carries the spring: k (q - rest) is the moment of the contacts, less friction.
  const BodyState& at = last->bodies[0];
  const Pose pose{at.orientation_xyzw.eigen().toRotationMatrix(), at.position_m.eigen()};
  const double spring_nm = 0.3 * (1.5 - positionOn(*panel.joint, panel.pose, pose));
  double moment_nm = 0.0;
  for (int i = 0; i < last->contact_count; ++i) {
    const Contact& c = last->contacts[i];
    const Eigen::Vector3d arm_m = c.point_m.eigen() - Eigen::Vector3d(0.24, 0.12, 0.0);
    moment_nm += arm_m.cross(c.force_n.eigen()).z() + c.torque_nm.z;
  }
  EXPECT_NEAR(moment_nm, spring_nm, 0.02 + 1e-3);
  const AxisEffort work = virtualWork(rig->models.hand, last->q_s, *last);
  EXPECT_LT(work[1], -0.5) << "pushed towards -y";
  EXPECT_NEAR(last->coupling[1], work[1], 0.02);
}

}  // namespace
}  // namespace wholehand::test
