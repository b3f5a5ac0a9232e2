// Trees of joints in the engine: contacts on every link, what the hand feels, rest.
#include "loop/physics/body_yard.hpp"
#include "loop/physics/joint_chain.hpp"
#include "loop/physics/power_grasp.hpp"
#include "support/tolerance.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand::test::trees {
namespace {

using Eigen::Vector3d;

constexpr double kTip_n = 8.0;
constexpr int kGrasped = 6000;  // ticks until the grasp has settled

/// A block out of the hand's reach.
SceneBody block(double mass_kg) {
  SceneBody body = bodyOf(boxShape({0.05, 0.05, 0.05}), {0.4, 0.041, 0.004}, mass_kg, 0.5);
  body.name = "block";
  return body;
}

/// A vertical bar where the power grasp needs it.
SceneBody handleBar(double radius_m, double mass_kg) {
  SceneBody body = bodyOf(roundShape(ShapeType::kCylinder, radius_m, 0.12),
                          {0.024 + radius_m, 0.041, 0.004}, mass_kg, 0.8);
  body.name = "handle";
  return body;
}

/// A person who takes the bar, which is body 1, and then moves the hand.
struct Grasped : PowerGrasp {
  std::function<Vector3d(int)> way;  ///< motion of the hand, by ticks since kGrasped

  Grasped(const std::vector<SceneBody>& bodies, std::function<Vector3d(int)> moves)
      : PowerGrasp(kTip_n, bodies, [this](int read) { return script(read); }),
        way(std::move(moves)) {}
  AxisPosition script(int read) {
    if (read < kGrasped) grasp(read);
    if (read > kGrasped) {
      const Vector3d to = way(read - kGrasped);
      for (int a = 0; a < 3; ++a) q_m[a] = to[a];
    }
    return q_m;
  }
  template <class Observe>
  void run(int ticks, const Observe& observe) {
    runTicks(*rig->renderer, ticks, [&](const TickRecord& r) {
      coupling = r.coupling;
      ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone) << "tick " << r.tick;
      observe(r);
    });
  }
};

Pose poseOf(const SceneBody& body, const BodyState& state) {
  const Eigen::Matrix3d turned = state.orientation_xyzw.eigen().toRotationMatrix();
  return {turned, state.position_m.eigen() - turned * body.com_m};
}

// A drawer of 2 N is pulled by a handle that turns in it. The contacts do the work of the drawer's
// friction and of what speeds both up (D'Alembert); the person feels the friction; the handle stays
// where its joint is in the drawer, exactly.
TEST(JointChain, DrawerPulledByAHandleThatTurns_RendersItsFriction) {
  SceneBody drawer = block(0.8);
  drawer.joint.emplace();
  drawer.joint->type = SceneJoint::Type::kSlide;
  drawer.joint->axis = -Vector3d::UnitX();
  drawer.joint->least = 0.0, drawer.joint->most = 0.12;
  drawer.joint->dry_friction = 2.0;
  SceneBody handle = handleBar(0.0125, 0.2);
  handle.joint.emplace();
  handle.joint->axis = Vector3d::UnitZ();
  handle.joint->parent = 0;
  const double apart_m = drawer.pose.translation_m.x() - handle.pose.translation_m.x();
  Grasped hand({drawer, handle},
               [](int k) { return Vector3d(-0.05 * std::min(1.0, k / 2000.0), 0, 0); });
  ASSERT_TRUE(hand.rig->renderer->arm());
  double worst_work = 0.0, worst_felt = 0.0, joint_error_m = 0.0, opened_m = 0.0;
  double most_inertial_n = 0.0, work_n = 0.0, rate_m_s = 0.0;
  const double mass_kg = drawer.mass_kg + handle.mass_kg;
  const double period_s = hand.rig->renderer->config().period_s;
  int counted = 0;
  hand.run(kGrasped + 2200, [&](const TickRecord& r) {
    const Vector3d front = r.bodies[0].position_m.eigen(), bar = r.bodies[1].position_m.eigen();
    joint_error_m = std::max(joint_error_m, (front - bar - Vector3d(apart_m, 0, 0)).norm());
    opened_m = drawer.pose.translation_m.x() - front.x();
    const double was_m_s = std::exchange(rate_m_s, -r.bodies[0].velocity_m_s.eigen().x());
    const int tick = static_cast<int>(r.tick);
    if (tick < kGrasped) return;
    const double did_n = std::exchange(work_n, virtualWork(hand.rig->models.hand, r.q_s, r)[0]);
    // The end does not bear the drawer, and it slides: friction has its full force.
    if (opened_m < 1e-3 || std::min(was_m_s, rate_m_s) < 1e-3) return;
    const double inertial_n = mass_kg * (rate_m_s - was_m_s) / period_s;
    worst_work = std::max(worst_work, std::abs(did_n - 2.0 - inertial_n));
    most_inertial_n = std::max(most_inertial_n, std::abs(inertial_n));
    if (tick <= kGrasped + 1300 || tick >= kGrasped + 1900) return;
    worst_felt = std::max(worst_felt, std::abs(r.coupling[0] - 2.0));
    ++counted;
  });
  figure("drawer with a handle that turns, virtual work, worst", worst_work, "N off");
  figure("the same, most of what speeds it up", most_inertial_n, "N");
  figure("drawer with a handle that turns, felt, worst", worst_felt, "N off");
  figure("the same, error of the joint", joint_error_m, "m");
  ASSERT_GT(counted, 500);
  EXPECT_GT(opened_m, 0.03);
  EXPECT_LE(worst_work, tolerance(1e-9));
  EXPECT_GT(most_inertial_n, 1e-3);
  EXPECT_LE(worst_felt, 0.02 * 2.0 + 0.05);
  EXPECT_LE(joint_error_m, 1e-15);
}

/// Positions and rates of a bar on a block, by their states.
struct Coordinates {
  Vector3d q = Vector3d::Zero(), rate = Vector3d::Zero();
};
Coordinates coordinatesOf(const std::vector<SceneBody>& bodies, const TickRecord& r) {
  const Pose of_block = poseOf(bodies[0], r.bodies[0]), of_bar = poseOf(bodies[1], r.bodies[1]);
  const Pose start = bodies[0].pose.inverse() * bodies[1].pose;
  Coordinates found;
  found.q[0] = positionOn(*bodies[0].joint, bodies[0].pose, of_block);
  found.q[1] = positionOn(*bodies[1].joint, start, of_block.inverse() * of_bar);
  const auto rate = [](const SceneJoint& joint, const Pose& at, const Vector3d& spin,
                       const Vector3d& velocity) {
    return (at.rotation * joint.axis).dot(joint.isHinge() ? spin : velocity);
  };
  const BodyState &a = r.bodies[0], &b = r.bodies[1];
  found.rate[0] =
      rate(*bodies[0].joint, of_block, a.angular_velocity_rad_s.eigen(), a.velocity_m_s.eigen());
  // Velocity of the block's point at the bar's centre.
  const Vector3d arm_m = b.position_m.eigen() - a.position_m.eigen();
  const Vector3d carried = a.velocity_m_s.eigen() + a.angular_velocity_rad_s.eigen().cross(arm_m);
  found.rate[1] = rate(*bodies[1].joint, of_bar,
                       b.angular_velocity_rad_s.eigen() - a.angular_velocity_rad_s.eigen(),
                       b.velocity_m_s.eigen() - carried);
  return found;
}

SceneJoint anyJoint(std::mt19937_64& random) {
  const auto any = [&] {
    return Vector3d(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
  };
  SceneJoint joint;
  joint.type = random() % 2 == 0 ? SceneJoint::Type::kHinge : SceneJoint::Type::kSlide;
  joint.axis = any().normalized();
  if (joint.isHinge()) joint.point_m = uniform(random, 0.05, 0.2) * any().normalized();
  joint.viscous_friction = uniform(random, 0.5, 5.0) * (joint.isHinge() ? 0.02 : 1.0);
  return joint;
}

// D'Alembert over one step: what the hand's contacts do to the coordinates, as virtual work at the
// bar's points, is the change of momentum beyond the tree's own motion.
TEST(JointChain, ContactsOnItsLastLink_DoTheirVirtualWork) {
  std::mt19937_64 random(seed() + 4);
  double worst = 0.0, most = 0.0;
  int counted = 0, free_of_drag = 0;
  constexpr int kMostDraws = 200;  // a bar that swings away at once is not touched
  for (int k = 0; k < cases(4) || (counted <= 100 && k < kMostDraws); ++k) {
    std::vector<SceneBody> bodies{
        block(uniform(random, 0.2, 2.0)),
        handleBar(uniform(random, 0.0125, 0.025), uniform(random, 0.1, 2.0))};
    bodies[0].joint = anyJoint(random);
    bodies[1].joint = anyJoint(random);
    bodies[1].joint->parent = 0;
    Grasped hand(bodies, [](int) { return Vector3d::Zero(); });
    ASSERT_TRUE(hand.rig->renderer->arm());
    const double period_s = hand.rig->renderer->config().period_s;
    const Vector3d gravity_m_s2 = hand.rig->models.scene.gravity_m_s2;
    JointChain chain(bodies, {0, 1});
    Coordinates then;
    TickRecord before;
    hand.run(2500, [&](const TickRecord& r) {
      const Coordinates now = coordinatesOf(bodies, r);
      if (before.contact_count > 0) {
        // The way of a point of the bar by each coordinate.
        const Pose of_block = poseOf(bodies[0], before.bodies[0]);
        const Pose of_bar = poseOf(bodies[1], before.bodies[1]);
        const std::array<Pose, 2> poses{of_block, of_bar};
        Vector3d hand_does = Vector3d::Zero();
        double scale = 0.0;
        for (int i = 0; i < before.contact_count; ++i) {
          const Contact& c = before.contacts[i];
          const Vector3d on_body = c.point_m.eigen() - c.distance_m * c.normal.eigen();
          for (int j = 0; j < 2; ++j) {
            const SceneJoint& joint = *bodies[j].joint;
            const Vector3d axis = poses[j].rotation * joint.axis;
            const Vector3d way =
                joint.isHinge() ? axis.cross(on_body - poses[j] * joint.point_m) : axis;
            double does = c.force_n.eigen().dot(way);
            if (joint.isHinge()) does += c.torque_nm.eigen().dot(axis);
            hand_does[j] -= does;
            scale += std::abs(does);
          }
        }
        chain.put(then.q, then.rate);
        chain.predict(gravity_m_s2, period_s, true);
        const Eigen::Matrix2d resists = chain.mobility().topLeftCorner<2, 2>().inverse();
        const Eigen::Vector2d rate = now.rate.head<2>();
        const Eigen::Vector2d rest =
            resists * (rate - chain.rate().head<2>()) / period_s - hand_does.head<2>();
        // Where the energy would have grown, the rates were scaled down: a drag along M q̇.
        const Eigen::Vector2d along = resists * rate / period_s;
        const double drag =
            along.squaredNorm() > 0.0 ? std::max(0.0, -rest.dot(along) / along.squaredNorm()) : 0.0;
        const double off = (rest + drag * along).norm();
        if (rest.norm() <= 1e-9 * (scale + 1.0)) ++free_of_drag;
        worst = std::max(worst, off / (scale + 1.0));
        most = std::max(most, hand_does.norm());
        ++counted;
      }
      before = r;
      then = now;
    });
  }
  figure("contacts on the last link of random chains, steps", counted, "");
  figure("virtual work of contacts on a chain, worst", worst, "of 1 N and the sum of forces");
  figure("of the steps without any drag", 1.0 * free_of_drag / std::max(1, counted), "");
  ASSERT_GT(counted, 100);
  EXPECT_GT(most, 1e-3);
  EXPECT_GT(free_of_drag, counted / 2);
  EXPECT_LE(worst, tolerance(1e-9));
}

/// A jaw along x on a hinge about z at the origin.
SceneBody jaw(double mass_kg) {
  SceneBody body = bodyOf(boxShape({0.16, 0.02, 0.02}), {0.08, 0, 0}, mass_kg, 0.0);
  body.joint.emplace();
  body.joint->axis = Vector3d::UnitZ();
  body.joint->point_m = {-0.08, 0, 0};
  return body;
}

// Pliers that rest: a ball strikes the jaw that follows, and both move, by the impulse times its
// lever over the inertia of both.
TEST(JointChain, BallOnTheJawThatFollows_MovesBothByItsImpulse) {
  std::mt19937_64 random(seed() + 5);
  std::vector<SceneBody> bodies{jaw(0.3), jaw(0.2)};
  bodies[0].pose.translation_m.z() = 0.1;
  bodies[1].joint->follows = 0, bodies[1].joint->ratio = -0.5;
  bodies.push_back(bodyOf(roundShape(ShapeType::kSphere, 0.01, 0.0), {0.12, 0.06, 0.0}, 0.05, 0.0));
  const auto moment = [](const SceneBody& body) {
    return body.inertia_kg_m2(2, 2) + body.mass_kg * 0.08 * 0.08;
  };
  const double inertia = moment(bodies[0]) + 0.25 * moment(bodies[1]);
  Yard yard("bullet", bodies, {0, 0, 0}, 1000.0, anyTurn(random));
  yard.run(1.0);
  EXPECT_EQ(yard.spin(0).norm(), 0.0);
  yard.throwBody(2, {0.0, -1.0, 0.0});
  yard.run(0.06);
  const double impulse = 0.05 * (yard.velocity(2).y() + 1.0);
  ASSERT_GT(impulse, 1e-3) << "the ball met the jaw";
  // The jaw's face is still within 1e-3 rad of x when it is struck.
  const double rate = 0.5 * 0.12 * impulse / inertia;
  EXPECT_NEAR(yard.spin(0).z(), rate, 0.01 * rate);
  EXPECT_NEAR(yard.spin(1).z(), -0.5 * yard.spin(0).z(), 1e-12);
  EXPECT_LT(yard.spin(1).z(), -0.1);
  EXPECT_NEAR(yard.joint(0).second, yard.spin(0).z(), 1e-12);
  EXPECT_NEAR(yard.joint(1).second, yard.spin(1).z(), 1e-12);
  EXPECT_NEAR(yard.joint(1).first, -0.5 * yard.joint(0).first, 1e-15);
}

// A chain that its friction holds comes to rest as a whole, and wakes as a whole.
TEST(JointChain, HeldByItsFriction_RestsAndWakesAsAWhole) {
  std::mt19937_64 random(seed() + 6);
  std::vector<SceneBody> bodies{jaw(0.3), jaw(0.2)};
  bodies[1].pose.translation_m.x() += 0.16;
  bodies[1].joint->parent = 0;
  for (SceneBody& body : bodies) body.joint->dry_friction = 0.02;
  bodies.push_back(bodyOf(roundShape(ShapeType::kSphere, 0.01, 0.0), {0.3, 0.3, 0.0}, 0.05, 0.0));
  Yard yard("bullet", bodies, {0, 0, 0}, 1000.0, anyTurn(random));
  yard.throwBody(2, {0.0, -2.0, 0.0});
  double fastest = 0.0;
  for (int k = 0; k < 400; ++k) {
    yard.step();
    fastest = std::max(fastest, yard.spin(0).norm());
  }
  EXPECT_GT(fastest, 0.01) << "the first link moves when the second one is struck";
  yard.run(2.0);
  EXPECT_EQ(yard.spin(0).norm(), 0.0);
  EXPECT_EQ(yard.spin(1).norm(), 0.0);
}

}  // namespace
}  // namespace wholehand::test::trees
