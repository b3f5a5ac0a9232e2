// Laws of bodies on one joint: closed forms of the issue, in a randomly rotated scene.
#include "loop/physics/body_joint.hpp"

#include "loop/physics/body_yard.hpp"

#include <cmath>
#include <numbers>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

SceneJoint slideAlong(const Vector3d& axis) {
  SceneJoint joint;
  joint.type = SceneJoint::Type::kSlide;
  joint.axis = axis.normalized();
  return joint;
}
SceneJoint hingeAbout(const Vector3d& axis, const Vector3d& point_m) {
  SceneJoint joint;
  joint.axis = axis.normalized();
  joint.point_m = point_m;
  return joint;
}

/// A body of a given moment of inertia about its own axes.
SceneBody rod(double mass_kg, const Vector3d& size_m, const Vector3d& center_m) {
  return bodyOf(boxShape(size_m), center_m, mass_kg, 0.5);
}

class BodyOnAJoint : public ::testing::Test {
 protected:
  std::mt19937_64 random_{seed()};
  const Eigen::Matrix3d turn_ = anyTurn(random_);
};

TEST_F(BodyOnAJoint, DrawerWithDryFriction_StopsWhereThePaperSays) {
  // 1 kg, 2 N, 0.3 m/s: v²/(2a) = 22.5 mm after v/a = 0.15 s.
  SceneBody drawer = rod(1.0, {0.2, 0.1, 0.05}, {0, 0, 0});
  drawer.joint = slideAlong({1, 0, 0});
  drawer.joint->least = -0.01, drawer.joint->most = 0.12;
  drawer.joint->dry_friction = 2.0;
  Yard yard("bullet", {drawer}, {0, 0, -9.81}, 1000.0, turn_);
  yard.throwBody(0, {0.3, 0, 0});
  yard.run(0.145);
  EXPECT_GT(yard.velocity(0).x(), 0.005);
  yard.run(0.01);
  EXPECT_NEAR(yard.velocity(0).norm(), 0.0, 1e-12);
  EXPECT_NEAR(yard.at(0).x(), 0.0225, 0.01 * 0.0225);
  EXPECT_NEAR(yard.at(0).tail<2>().norm(), 0.0, 1e-13);  // rounding of the rotated scene
  yard.run(1.0);
  EXPECT_NEAR(yard.at(0).x(), 0.0225, 0.01 * 0.0225);
}

TEST_F(BodyOnAJoint, DrawerAtItsEnd_StopsThere) {
  SceneBody drawer = rod(1.0, {0.2, 0.1, 0.05}, {0, 0, 0});
  drawer.joint = slideAlong({0.6, 0, 0.8});
  drawer.joint->least = -0.02, drawer.joint->most = 0.05;
  Yard yard("bullet", {drawer}, {0, 0, -9.81}, 1000.0, turn_);
  yard.run(1.0);  // falls along its slide to the lower end
  EXPECT_NEAR(yard.at(0).dot(Vector3d(0.6, 0, 0.8)), -0.02, 1e-13);
  EXPECT_NEAR(yard.velocity(0).norm(), 0.0, 1e-12);
}

TEST_F(BodyOnAJoint, SwingingLid_HasThePendulumPeriodAndGainsNoEnergy) {
  // A thin uniform rod of 20 g and 40 mm hinged at its end: T = 2π √(2L/3g) = 0.3276 s. A box that
  // is not thin has I = m (L² + w²)/12 + m L²/4 in place of m L²/3.
  const double length_m = 0.04, width_m = 0.002;
  SceneBody lid = rod(0.02, {width_m, width_m, length_m}, {0, 0, 0});
  lid.joint = hingeAbout({0, 1, 0}, {0, 0, 0.5 * length_m});
  for (const double rate_hz : {1000.0, 4000.0}) {
    Yard yard("bullet", {lid}, {0, 0, -9.81}, rate_hz, turn_);
    const double inertia =
        0.02 * ((length_m * length_m + width_m * width_m) / 12.0 + length_m * length_m / 4.0);
    const double period_s = 2.0 * pi * std::sqrt(inertia / (0.02 * 9.81 * 0.5 * length_m));
    if (rate_hz == 1000.0) EXPECT_NEAR(period_s, 0.3276, 0.002 * 0.3276);
    yard.throwBody(0, {0.02, 0, 0});
    double before = yard.velocity(0).x(), first_peak = 0.0, time_s = 0.0, crossed_s = 0.0;
    double last_s = 0.0;
    int crossings = 0;
    for (int k = 1; k < static_cast<int>(10.0 * rate_hz); ++k) {
      yard.step();
      time_s = k / rate_hz;
      const double now = yard.velocity(0).x();
      if (before > 0.0 && now <= 0.0) {  // a turning point, where it hangs farthest
        last_s = time_s - now / (now - before) / rate_hz;
        const double peak = yard.at(0).x();
        if (crossings == 0) first_peak = peak, crossed_s = last_s;
        EXPECT_LE(peak, first_peak * (1.0 + 0.011 * 1000.0 / rate_hz)) << "swing " << crossings;
        EXPECT_GE(peak, first_peak * 0.98) << "swing " << crossings;
        ++crossings;
      }
      before = now;
    }
    const double measured_s = (last_s - crossed_s) / (crossings - 1);
    figure("lid, free period at " + std::to_string(static_cast<int>(rate_hz)) + " Hz", measured_s,
           "s");
    // The amplitude adds θ₀²/16 to the period: θ₀ = 0.02/(ω · 20 mm) = 0.052 rad, 1.7e-4.
    EXPECT_NEAR(measured_s, period_s * (1.0 + 1.7e-4), 1e-3 * period_s);
  }
}

TEST_F(BodyOnAJoint, LatchHoldsUpToItsTorque) {
  // n = 8, U₀ = 20 mJ: U₀ n/2 = 0.080 N·m. A weight of 1 kg at r turns the knob's shaft.
  for (const double share : {0.99, 1.01}) {
    SceneBody knob = rod(0.1, {0.04, 0.04, 0.04}, {0, 0, 0});
    const double arm_m = share * 0.080 / (0.1 * 9.81);
    knob.joint = hingeAbout({0, 1, 0}, {-arm_m, 0, 0});
    knob.joint->latch_energy_j = 0.02;
    knob.joint->latch_wave = 8.0;
    // The largest torque is a quarter of a wave below the detent; the arm also turns there.
    knob.joint->latch_at = -pi / 16.0;
    Yard yard("bullet", {knob}, {0, 0, -9.81}, 1000.0, turn_);
    yard.run(0.02);
    // At the crest: with share 0.99 it turns back, with 1.01 it goes on downward (about +y, x falls
    // to −z).
    if (share < 1.0) {
      EXPECT_GT(yard.velocity(0).z(), 0.0);
    } else {
      EXPECT_LT(yard.velocity(0).z(), 0.0);
    }
  }
}

TEST_F(BodyOnAJoint, SpringOfALever_HoldsItsEnergy) {
  // 300 N/m, 15 mm: 4.5 N and 33.75 mJ. A weight of 4.5 N rests 15 mm below.
  SceneBody lever = rod(4.5 / 9.81, {0.05, 0.05, 0.05}, {0, 0, 0});
  lever.joint = slideAlong({0, 0, 1});
  lever.joint->spring_stiffness = 300.0;
  lever.joint->viscous_friction = 30.0;
  Yard yard("bullet", {lever}, {0, 0, -9.81}, 1000.0, turn_);
  yard.run(5.0);
  EXPECT_NEAR(yard.at(0).z(), -0.015, 1e-6);
  BodyJoint joint(lever);
  joint.put(-0.015, 0.0);
  EXPECT_NEAR(joint.energy(), 33.75e-3, 1e-12);
}

TEST_F(BodyOnAJoint, DoorHitAtItsHandle_ActsAsItsReducedMass) {
  // I = 0.05 kg·m² about the hinge, r = 0.15 m: I/r² = 2.222 kg. A ball of 1 kg that arrives at 0.5
  // m/s and does not bounce moves on with it at 0.5/(1 + 2.222).
  const Vector3d size_m(0.02, 0.3, 0.2);
  const double width_m = 0.3;
  SceneBody door = rod(1.0, size_m, {0, 0.5 * width_m, 0});
  door.mass_kg = 0.05 / ((width_m * width_m + 0.02 * 0.02) / 12.0 + width_m * width_m / 4.0);
  door.inertia_kg_m2 *= door.mass_kg;
  door.joint = hingeAbout({0, 0, 1}, {0, -0.5 * width_m, 0});
  EXPECT_NEAR(BodyJoint(door).inertia(), 0.05, 1e-12);
  SceneBody ball = bodyOf(roundShape(ShapeType::kSphere, 0.02, 0.0), {-0.04, 0.15, 0.03}, 1.0, 0.0);
  Yard yard("bullet", {door, ball}, Vector3d::Zero(), 1000.0, turn_);
  yard.throwBody(1, {0.5, 0, 0});
  yard.run(0.06);
  const double together = 0.5 / (1.0 + 0.05 / (0.15 * 0.15));
  EXPECT_NEAR(yard.velocity(1).x(), together, 0.01 * together);
  EXPECT_NEAR(-yard.spin(0).z() * 0.15, together, 0.01 * together);
}

TEST_F(BodyOnAJoint, DrawerHitAtAnAngle_ReceivesTheComponentAlongItsSlide) {
  // A frictionless ball hits the drawer's face with normal n and slide axis a: the face acts with
  // the mass M/(n·a)².
  const Vector3d axis = Vector3d(1, 1, 0).normalized();
  SceneBody drawer = rod(2.0, {0.1, 0.1, 0.1}, {0, 0, 0});
  drawer.friction = 0.0;
  drawer.joint = slideAlong(axis);
  SceneBody ball = bodyOf(roundShape(ShapeType::kSphere, 0.02, 0.0), {-0.08, 0.0, 0.0}, 1.0, 0.0);
  Yard yard("bullet", {drawer, ball}, Vector3d::Zero(), 1000.0, turn_);
  yard.throwBody(1, {0.4, 0, 0});
  yard.run(0.05);
  const double mass_kg = 2.0 / 0.5;
  const double along_normal = 0.4 / (1.0 + mass_kg);
  EXPECT_NEAR(yard.velocity(0).x(), along_normal, 0.01 * along_normal);
  EXPECT_NEAR(yard.velocity(0).y(), along_normal, 0.01 * along_normal);
  EXPECT_NEAR(yard.velocity(0).z(), 0.0, 1e-12);
}

TEST_F(BodyOnAJoint, CupInADrawer_MovesWithItAndRests) {
  SceneBody drawer = rod(1.0, {0.2, 0.2, 0.02}, {0, 0, 0});
  drawer.joint = slideAlong({1, 0, 0});
  drawer.joint->least = 0.0, drawer.joint->most = 0.12;
  drawer.joint->dry_friction = 0.5;
  SceneBody cup = bodyOf(boxShape({0.04, 0.04, 0.04}), {0, 0, 0.03}, 0.1, 0.5);
  Yard yard("bullet", {drawer, cup}, {0, 0, -9.81}, 1000.0, turn_);
  yard.throwBody(0, {0.1, 0, 0});
  yard.run(1.0);
  // Momentum: friction accelerates the cup, then 0.5 N stop both.
  EXPECT_NEAR(yard.velocity(0).norm(), 0.0, 1e-6);
  EXPECT_NEAR(yard.at(1).z(), 0.03, 1e-4);
  EXPECT_NEAR(yard.at(1).y(), 0.0, 1e-5);
  EXPECT_GT(yard.at(0).x(), 0.005);
  EXPECT_NEAR(yard.at(1).x(), yard.at(0).x(), 0.003);
}

// Dry friction and the ends of a range only take energy; spring and latch keep it.
TEST_F(BodyOnAJoint, AnyJoint_GainsNoEnergyAndStaysOnItsPath) {
  for (int trial = 0; trial < cases(60); ++trial) {
    const Vector3d axis(uniform(random_, -1, 1), uniform(random_, -1, 1), uniform(random_, -1, 1));
    SceneBody body = rod(uniform(random_, 0.1, 2.0), {0.05, 0.1, 0.02}, {0, 0, 0});
    const bool hinge = trial % 2 == 0, latch = trial % 3 == 0;
    body.joint =
        hinge ? hingeAbout(axis, {0.1, 0.05, uniform(random_, -0.1, 0.1)}) : slideAlong(axis);
    body.joint->dry_friction = uniform(random_, 0.0, hinge ? 0.01 : 0.5);
    if (latch) {
      body.joint->latch_energy_j = uniform(random_, 0.0, 0.02);
      body.joint->latch_wave = hinge ? 8.0 : 2.0 * pi / 0.02;
    } else {
      body.joint->spring_stiffness = uniform(random_, 0.0, hinge ? 5.0 : 500.0);
      if (hinge) body.joint->least = -3.0, body.joint->most = 3.0;  // each pose has one q
    }
    Yard yard("bullet", {body}, Vector3d::Zero(), 1000.0, turn_);
    yard.throwBody(0, Vector3d(uniform(random_, -0.5, 0.5), uniform(random_, -0.5, 0.5), 0.1));
    BodyJoint law(body);
    const auto energy = [&] {
      law.put(law.nearest({yard.axes(0), yard.at(0)}), 0.0);
      const BodyJoint::Twist twist = law.twist();
      const double rate =
          hinge ? twist.angular.dot(yard.spin(0)) : twist.linear.dot(yard.velocity(0));
      // A pose tells a hinge's position but for whole turns.
      const double apart = yard.joint(0).first - law.position();
      EXPECT_NEAR(hinge ? std::remainder(apart, 2.0 * pi) : apart, 0.0, 1e-12);
      EXPECT_NEAR(yard.joint(0).second, rate, 1e-12 * (1.0 + std::abs(rate)));
      EXPECT_LE((law.pose().translation_m - yard.at(0)).norm(), 1e-12);
      EXPECT_LE((law.pose().rotation - yard.axes(0)).norm(), 1e-12);
      EXPECT_LE((rate * twist.linear - yard.velocity(0)).norm(), 1e-12);
      law.put(law.position(), rate);
      return law.energy();
    };
    double before = energy();
    for (int k = 0; k < 1000 && !HasFailure(); ++k) {
      yard.step();
      const double now = energy();
      EXPECT_LE(now, before * (1.0 + 1e-9) + 1e-12) << "trial " << trial << ", step " << k;
      before = now;
    }
    if (HasFailure()) return;
  }
}

// What is slow moves as the law says, from the first step on: no speed is so low that it counts as
// rest while nothing holds the load.
TEST_F(BodyOnAJoint, SoftClosingDrawer_CreepsToItsEnd) {
  // Spring k to 40 mm against a damper c: q = 40 mm (1 − e^(−k t / c)), begun at k · 40 mm / c.
  // Bodies once counted as still below 0.5 mm/s.
  for (int i = 0; i < 4; ++i) {
    SceneBody drawer = rod(1.0, {0.2, 0.1, 0.05}, {0, 0, 0});
    drawer.joint = slideAlong({1, 0, 0});
    drawer.joint->least = -0.01, drawer.joint->most = 0.1;
    drawer.joint->viscous_friction = 1000.0;
    drawer.joint->spring_rest = 0.04;
    const double begin_m_s = 5e-4 * std::pow(10.0, uniform(random_, -3.0, 0.3));
    drawer.joint->spring_stiffness = begin_m_s * 1000.0 / 0.04;
    Yard yard("bullet", {drawer}, {0, 0, -9.81}, 1000.0, turn_);
    const double seconds = 3.0;
    yard.run(seconds);
    const double way_m = 0.04 * (1.0 - std::exp(-begin_m_s * seconds / 0.04));
    EXPECT_NEAR(yard.at(0).x(), way_m, 0.005 * way_m) << begin_m_s << " m/s";
  }
}

TEST_F(BodyOnAJoint, WeakSpring_SwingsFromRest) {
  // 1 kg, 1 N/m, 20 mm away: q = 20 mm (1 − cos ωt), 40 mm after half a period of 6.28 s.
  SceneBody drawer = rod(1.0, {0.2, 0.1, 0.05}, {0, 0, 0});
  drawer.joint = slideAlong({1, 0, 0});
  drawer.joint->least = -0.01, drawer.joint->most = 0.1;
  drawer.joint->spring_stiffness = 1.0, drawer.joint->spring_rest = 0.02;
  Yard yard("bullet", {drawer}, {0, 0, -9.81}, 1000.0, turn_);
  yard.run(pi);
  EXPECT_NEAR(yard.at(0).x(), 0.04, 1e-4);
}

TEST_F(BodyOnAJoint, LoadWithinDryFriction_StaysToTheBit) {
  SceneBody drawer = rod(1.0, {0.2, 0.1, 0.05}, {0, 0, 0});
  drawer.joint = slideAlong({1, 0, 0});
  drawer.joint->least = -0.01, drawer.joint->most = 0.1;
  drawer.joint->spring_stiffness = 100.0, drawer.joint->spring_rest = 0.02;
  drawer.joint->dry_friction = 2.1;  // more than 100 N/m · 20 mm
  Yard yard("bullet", {drawer}, {0, 0, -9.81}, 1000.0, turn_);
  const Vector3d from = yard.at(0);
  yard.run(0.5);
  EXPECT_EQ(yard.at(0), from);
}

// A slope of 0.1°: a ball rolls with 5/7 g sin α, a can with 2/3 g sin α.
TEST_F(BodyOnAJoint, SlightSlope_MakesRoundBodiesRoll) {
  const double slope_rad = 0.1 * pi / 180.0, seconds = 2.0;
  const Vector3d gravity = 9.81 * Vector3d(std::sin(slope_rad), 0.0, -std::cos(slope_rad));
  const Eigen::Matrix3d lying = Eigen::AngleAxisd(0.5 * pi, Vector3d::UnitX()).toRotationMatrix();
  Yard yard("bullet",
            {ground(0.8), bodyOf(roundShape(ShapeType::kSphere, 0.03, 0.0), {0, 0, 0.03}, 0.1, 0.8),
             bodyOf(roundShape(ShapeType::kCylinder, 0.03, 0.1), {0, 0.5, 0.03}, 0.1, 0.8, lying)},
            gravity, 1000.0, turn_);
  yard.run(seconds);
  const double way_m = 0.5 * gravity.x() * seconds * seconds;
  EXPECT_NEAR(yard.at(1).x(), 5.0 / 7.0 * way_m, 0.02 * way_m);
  EXPECT_NEAR(yard.at(2).x(), 2.0 / 3.0 * way_m, 0.02 * way_m);
}

}  // namespace
}  // namespace wholehand::test
