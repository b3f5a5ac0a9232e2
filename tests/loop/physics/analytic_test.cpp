#include "files/shipped_models.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/physics/analytic/analytic_world.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

/// A mass on a rail along x.
HandModel slider(double mass_kg) {
  HandModel hand;
  hand.joint_count = hand.axis_count = 1;
  hand.joint_names = hand.axis_names = {"x"};
  HandLink link;
  link.name = "x";
  link.type = JointType::kPrismatic;
  link.joint = 0;
  link.mass_kg = mass_kg;
  link.inertia_kg_m2 = 1e-6 * Eigen::Matrix3d::Identity();
  hand.links.push_back(link);
  hand.synergy = JointAxisMatrix::Ones(1, 1);
  hand.theta0 = JointPosition(1);
  hand.reference = AxisPosition(1);
  return hand;
}

AnalyticScene along(const AnalyticAxis& axis) {
  AnalyticScene scene;
  scene.axes = {axis};
  return scene;
}

/// A slider at rest with one analytic element.
struct Placed {
  Placed(double mass_kg, const AnalyticAxis& axis, double at_m)
      : hand(slider(mass_kg)), world(hand, along(axis)) {
    EXPECT_TRUE(world.placeHand(AxisPosition(1, at_m)).ok());
  }
  HandModel hand;
  AnalyticWorld world;
};

HandDrive push(double effort) {
  return {{}, JointEffort(1, effort), {}, {}, nullptr};
}

PhysicsState stateOfWorld(AnalyticWorld& world) {
  PhysicsState s;
  EXPECT_EQ(world.observe(s), Fault::kNone);
  return s;
}

TEST(AnalyticWorld, CriticallyDampedFreeMotion_FollowsTheDoublePole) {
  const HandModel hand = slider(0.25);
  AnalyticWorld world(hand, {});
  ASSERT_TRUE(world.placeHand(AxisPosition(1, 0.01)).ok());
  const double kp = 2500.0, kd = criticalDamping(kp, kPeriod_s), pole = 0.95;
  for (int k = 0; k < 200; ++k) {
    const PhysicsState s = stateOfWorld(world);
    // x[k] = (A + B k) poleᵏ; from rest x[1] = (1 − T²k_p) x[0].
    const double b = ((1.0 - kPeriod_s * kPeriod_s * kp) / pole - 1.0) * 0.01;
    ASSERT_NEAR(s.q_s[0], (0.01 + b * k) * std::pow(pole, k), tolerance(1e-13)) << k;
    ASSERT_EQ(world.step(push(0.25 * (-kp * s.q_s[0] - kd * s.qd_s[0])), kPeriod_s), Fault::kNone);
  }
}

TEST(AnalyticWorld, PlacedBodies_DoNotExist) {
  const HandModel hand = slider(0.25);
  AnalyticWorld world(hand, {});
  BodyPlacements placements;
  placements.count = 1;
  placements.items[0].body = 0;
  world.placeBodies(placements);
  PhysicsState s;
  s.body_count = 3;  // left over from another world
  ASSERT_EQ(world.observe(s), Fault::kNone);
  EXPECT_EQ(s.body_count, 0);
}

TEST(AnalyticWorld, RigidStop_IsReachedExactlyAndHoldsTheDrivingEffort) {
  AnalyticAxis wall;
  wall.upper_stop = 0.02;
  Placed placed(0.25, wall, 0.0);
  AnalyticWorld& world = placed.world;
  for (int k = 0; k < 300; ++k) {
    ASSERT_EQ(world.step(push(5.0), kPeriod_s), Fault::kNone);
    ASSERT_LE(stateOfWorld(world).q_s[0], 0.02 + 1e-15);
  }
  EXPECT_NEAR(stateOfWorld(world).q_s[0], 0.02, tolerance(1e-15));
  EXPECT_NEAR(stateOfWorld(world).qd_s[0], 0.0, tolerance(1e-12));
  EXPECT_NEAR(world.stopEffort()[0], -5.0, tolerance(1e-12));
  ContactList contacts;
  world.contacts(contacts);
  ASSERT_EQ(contacts.count, 1);
  EXPECT_NEAR(contacts.points[0].force_n.x, -5.0, tolerance(1e-12));
  EXPECT_EQ(contacts.points[0].normal.x, -1.0);
  EXPECT_EQ(contacts.points[0].link, 0);
  // A stop never pulls.
  ASSERT_EQ(world.step(push(-1.0), kPeriod_s), Fault::kNone);
  world.contacts(contacts);
  EXPECT_EQ(contacts.count, 0);
  EXPECT_LT(stateOfWorld(world).q_s[0], 0.02);
}

TEST(AnalyticWorld, Spring_SwingsWithItsPeriodAndKeepsItsEnergy) {
  AnalyticAxis spring;
  spring.stiffness = 50.0;
  spring.spring_rest = 0.1;
  Placed placed(0.5, spring, 0.15);
  AnalyticWorld& world = placed.world;
  // Symplectic Euler keeps ½ m v² + ½ k x² − ½ T k x v exactly; its angle per step is 2 asin(T
  // √(k/m) / 2).
  const auto kept = [&] {
    const PhysicsState s = stateOfWorld(world);
    const double x = s.q_s[0] - 0.1, v = s.qd_s[0];
    return 0.25 * v * v + 25.0 * x * x - 25.0 * kPeriod_s * x * v;
  };
  const double before = kept();
  const double angle = 2.0 * std::asin(0.5 * kPeriod_s * std::sqrt(50.0 / 0.5));
  for (int k = 1; k <= 5000; ++k) {
    ASSERT_EQ(world.step(push(0.0), kPeriod_s), Fault::kNone);
    ASSERT_NEAR(kept(), before, tolerance(1e-12) * before);
  }
  // x[k] = 0.05 (cos kφ − tan(φ/2) sin kφ): starts at rest half a step late.
  const double expected =
      0.05 * (std::cos(5000 * angle) - std::tan(angle / 2.0) * std::sin(5000 * angle));
  EXPECT_NEAR(stateOfWorld(world).q_s[0] - 0.1, expected, tolerance(1e-11));
}

TEST(AnalyticWorld, AttachedMass_SharesTheEffort) {
  AnalyticAxis carried;
  carried.added_mass = 0.15;
  Placed placed(0.25, carried, 0.0);
  AnalyticWorld& world = placed.world;
  ASSERT_EQ(world.step(push(2.0), kPeriod_s), Fault::kNone);
  EXPECT_NEAR(stateOfWorld(world).qd_s[0], 2.0 / 0.4 * kPeriod_s, tolerance(1e-15));
}

TEST(AnalyticWorld, Damper_DecaysExponentially) {
  AnalyticAxis oil;
  oil.damping = 2.0;
  Placed placed(0.25, oil, 0.0);
  AnalyticWorld& world = placed.world;
  ASSERT_EQ(world.step(push(250.0), kPeriod_s), Fault::kNone);  // 1 m/s
  for (int k = 0; k < 100; ++k) ASSERT_EQ(world.step(push(0.0), kPeriod_s), Fault::kNone);
  EXPECT_NEAR(stateOfWorld(world).qd_s[0], std::pow(1.0 - kPeriod_s * 2.0 / 0.25, 100),
              tolerance(1e-12));
}

TEST(AnalyticWorld, HandInsideAStop_IsRefusedByName) {
  const HandModel hand = slider(0.25);
  AnalyticAxis wall;
  wall.upper_stop = 0.02;
  AnalyticWorld world(hand, along(wall));
  const Expected<Done> placed = world.placeHand(AxisPosition(1, 0.03));
  ASSERT_FALSE(placed.ok());
  EXPECT_EQ(placed.errors()[0].key, "x");
}

TEST(AnalyticWorld, NonFiniteTorque_IsAFault) {
  const HandModel hand = slider(0.25);
  AnalyticWorld world(hand, {});
  EXPECT_EQ(world.step(push(std::nan("")), kPeriod_s), Fault::kNonFiniteState);
  PhysicsState s;
  EXPECT_EQ(world.observe(s), Fault::kNonFiniteState);
}

// ---- the shipped hand

class AnalyticHand : public testing::Test {
 protected:
  /// Applies Eq. (2) towards `target` through the renderer's own distribution of torques.
  void drive(AnalyticWorld& world, const AxisPosition& target, int ticks) {
    ArticulatedBody body(hand_);
    gains_.axes = hand_.axis_count;
    gains_.k_pm = AxisStiffness(gains_.axes);
    for (int k = 0; k < ticks; ++k) {
      ASSERT_EQ(world.observe(state_), Fault::kNone);
      ASSERT_TRUE(body.update(state_.theta, state_.theta_dot, {0.0, 0.0, -9.81}));
      for (int a = 0; k == 0 && a < gains_.axes; ++a) {
        gains_.k_pm[a] = 3900.0 * body.reducedInertia()(a, a);
      }
      f_s_ = avatarEffort(target, AxisVelocity(gains_.axes), state_.q_s, state_.qd_s,
                          avatarDamping(body.reducedInertia(), gains_.k_pm, kPeriod_s), gains_);
      HandDrive out;
      body.distribute(f_s_, out.torque);
      ASSERT_EQ(world.step(out, kPeriod_s), Fault::kNone);
    }
  }

  HandModel hand_ = handNamed();
  CouplingGains gains_;
  PhysicsState state_;
  AxisEffort f_s_;
};

TEST_F(AnalyticHand, FreeUnderGravity_SettlesExactlyAtItsTarget) {
  AnalyticWorld world(hand_, {});
  ASSERT_TRUE(world.placeHand(hand_.reference).ok());
  AxisPosition target = hand_.reference;
  for (int a = 0; a < target.size(); ++a) target[a] += 0.02 * (a + 1);
  drive(world, target, 2000);
  // The coupling carries no load: h compensates gravity, so the hand does not sag.
  EXPECT_LE((state_.q_s.vec() - target.vec()).cwiseAbs().maxCoeff(), tolerance(1e-9));
}

TEST_F(AnalyticHand, StopsOnTwoAxes_CarryExactlyTheCouplingEffortAtRest) {
  AnalyticScene scene;
  scene.axes.resize(hand_.axis_count);
  const int x = 0, last = hand_.axis_count - 1;
  scene.axes[x].upper_stop = hand_.reference[x] + 0.005;
  scene.axes[last].upper_stop = hand_.reference[last] + 0.05;
  AnalyticWorld world(hand_, scene);
  ASSERT_TRUE(world.placeHand(hand_.reference).ok());
  AxisPosition target = hand_.reference;
  target[x] += 0.01;
  target[last] += 0.2;
  drive(world, target, 3000);
  for (int a = 0; a < hand_.axis_count; ++a) {
    EXPECT_NEAR(world.stopEffort()[a], -f_s_[a], tolerance(1e-9)) << hand_.axis_names[a];
  }
  EXPECT_GT(f_s_[x], 1.0);  // about 0.25 kg · 3900 s⁻² · 5 mm
  EXPECT_GT(f_s_[last], 1e-3);
  ContactList contacts;
  world.contacts(contacts);
  EXPECT_EQ(contacts.count, 2);
}

TEST_F(AnalyticHand, StopsOnEveryAxis_AreNotPassedInOneStepDespiteCoupledInertia) {
  AnalyticScene scene;
  scene.axes.resize(hand_.axis_count);
  for (int a = 0; a < hand_.axis_count; ++a) scene.axes[a].upper_stop = hand_.reference[a];
  AnalyticWorld world(hand_, scene);
  ASSERT_TRUE(world.placeHand(hand_.reference).ok());
  HandDrive push{{}, JointEffort(hand_.joint_count, 0.2), {}, {}, nullptr};
  for (int j = 0; j < 3; ++j) push.torque[j] = 20.0;
  ASSERT_EQ(world.step(push, kPeriod_s), Fault::kNone);
  ASSERT_EQ(world.observe(state_), Fault::kNone);
  for (int a = 0; a < hand_.axis_count; ++a) {
    EXPECT_LE(state_.q_s[a] - hand_.reference[a], tolerance(1e-12)) << hand_.axis_names[a];
  }
}

TEST_F(AnalyticHand, Tick_DoesNotAllocate) {
  AnalyticWorld world(hand_, {});
  const HandDrive none{{}, JointEffort(hand_.joint_count), {}, {}, nullptr};
  ContactList contacts;
  const AllocationScope scope;
  Fault fault = world.observe(state_);
  fault |= world.step(none, kPeriod_s);
  world.contacts(contacts);
  EXPECT_EQ(scope.allocations(), 0U);
  EXPECT_EQ(fault, Fault::kNone);
}

}  // namespace
}  // namespace wholehand::test
