// Energy that bodies hold, receive and gain, compared with closed forms of mechanics.
#include "loop/safety/body_energy.hpp"

#include "support/constants.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

constexpr double kMass_kg = 0.4, kRadius_m = 0.05;

/// A moving ball, a fixed wall and the states that an engine would report.
class Watched {
 public:
  Watched() {
    scene_.bodies = {ball({0.0, 0.0, 1.0}, kRadius_m, kMass_kg), wall({1.0, 0.0, 0.0}, 0.5)};
    bodies_ = std::make_unique<BodyEnergy>(scene_, kPeriod_s);
    record_.body_count = 2;
  }
  BodyState& state(int body) { return record_.bodies[body]; }
  Contact& touch(int body) {
    Contact& contact = contacts_[count_++];
    contact.body = body;
    return contact;
  }
  /// Advances by one step.
  void check(const PoolEnergy& pool = {}) {
    bodies_->advance(record_, contacts_.data(), count_, pool);
    count_ = 0;
  }
  void place(int body, const Vec3& at_m, const Vec3& velocity_m_s) {
    BodyPlacements placed;
    placed.count = 1;
    placed.items[0].body = body;
    placed.items[0].position_m = at_m;
    placed.items[0].velocity_m_s = velocity_m_s;
    bodies_->notePlaced(placed, record_);
    record_.bodies[body].position_m = at_m;
    record_.bodies[body].velocity_m_s = velocity_m_s;
  }
  [[nodiscard]] double held() const { return bodies_->energy().held_j; }
  [[nodiscard]] double received() const { return bodies_->energy().received_j; }
  [[nodiscard]] double gained() const { return bodies_->gained_j(); }

 private:
  SceneModel scene_;
  std::unique_ptr<BodyEnergy> bodies_;
  TickRecord record_;
  std::array<Contact, 4> contacts_{};
  int count_ = 0;
};

TEST(BodyEnergy, FallingBall_HoldsTheEnergyOfGravity) {
  Watched w;
  w.check();
  double received_j = 0.0;
  for (int k = 1; k <= 1000; ++k) {  // symplectic Euler, as every engine steps
    w.state(0).velocity_m_s.z -= 9.81 * kPeriod_s;
    w.check();
    received_j += w.received();
    ASSERT_NEAR(w.gained(), 0.0, 1e-12);
  }
  EXPECT_NEAR(w.held(), 0.5 * kMass_kg * 9.81 * 9.81, 1e-9);
  EXPECT_NEAR(received_j, w.held(), 1e-9);
}

/// A scene with a ball of kMass_kg on a joint at its start position.
SceneModel onJoint(const SceneJoint& joint) {
  SceneModel scene;
  scene.gravity_m_s2.setZero();
  scene.bodies = {ball({0.3, 0.0, 0.1}, kRadius_m, kMass_kg)};
  scene.bodies[0].joint = joint;
  return scene;
}

// A mass on a spring, released at A: ½ m v² + ½ k x² stays ½ k A², and no energy is received.
TEST(BodyEnergy, MassOnASpring_KeepsTheStoredEnergy) {
  SceneJoint joint;
  joint.type = SceneJoint::Type::kSlide;
  joint.axis = Eigen::Vector3d::UnitY();
  joint.spring_stiffness = 300.0;
  const SceneModel scene = onJoint(joint);
  BodyEnergy energy(scene, kPeriod_s);
  TickRecord record;
  record.body_count = 1;
  const double rate = std::sqrt(300.0 / kMass_kg), far_m = 0.015;
  for (int k = 0; k < 1000; ++k) {
    const double phase = rate * kPeriod_s * k;
    record.bodies[0].position_m = {0.3, far_m * std::cos(phase), 0.1};
    record.bodies[0].velocity_m_s = {0.0, -far_m * rate * std::sin(phase), 0.0};
    energy.advance(record, nullptr, 0, {});
    ASSERT_NEAR(energy.energy().held_j, 33.75e-3, 1e-12) << k;  // 300 N/m, 15 mm
    ASSERT_NEAR(energy.gained_j(), 0.0, 1e-12) << k;
    ASSERT_EQ(energy.energy().received_j, 0.0) << k;
  }
}

// A latch turned from detent to detent stores U₀ sin²(n q/2), over whole turns; an exercise that
// places it on a crest gives U₀.
TEST(BodyEnergy, Latch_HoldsItsStoredEnergyAndReceivesThatOfAPlacement) {
  SceneJoint joint;
  joint.axis = Eigen::Vector3d::UnitZ();
  joint.latch_energy_j = 0.02;
  joint.latch_wave = 5.0;
  const SceneModel scene = onJoint(joint);
  BodyEnergy energy(scene, kPeriod_s);
  TickRecord record;
  record.body_count = 1;
  record.bodies[0].position_m = {0.3, 0.0, 0.1};
  const auto turned = [](double q) {
    return QuatXyzw::from(Eigen::Quaterniond(Eigen::AngleAxisd(q, Eigen::Vector3d::UnitZ())));
  };
  for (int k = 0; k < 500; ++k) {
    const double q = 0.02 * k;  // more than a turn
    record.bodies[0].orientation_xyzw = turned(q);
    energy.advance(record, nullptr, 0, {});
    ASSERT_NEAR(energy.energy().held_j, 0.02 * std::pow(std::sin(2.5 * q), 2), 1e-13) << k;
  }
  record.bodies[0].orientation_xyzw = turned(0.0);
  energy.advance(record, nullptr, 0, {});
  BodyPlacements placed;
  placed.count = 1;
  placed.items[0] = {0, 0, record.bodies[0].position_m, turned(kPi / 5.0), {}};
  energy.notePlaced(placed, record);
  record.bodies[0].orientation_xyzw = turned(kPi / 5.0);
  energy.advance(record, nullptr, 0, {});
  EXPECT_NEAR(energy.energy().received_j, 0.02, 1e-13);
  EXPECT_NEAR(energy.energy().held_j, 0.02, 1e-13);
  EXPECT_NEAR(energy.gained_j(), 0.0, 1e-13);
}

// Hinges of any range to ten turns, led through it slowly against a spring: what they hold is
// ½ k (q − q₀)² + ½ I q̇², whatever the number of turns.
TEST(BodyEnergy, HingeOfAnyRange_HoldsTheStoredEnergyOfItsTurns) {
  auto random = seededRandom(6104);
  for (int i = 0; i < 300; ++i) {
    SceneJoint joint;
    joint.axis = Eigen::Vector3d::UnitY();
    joint.least = -uniform(random, 0.0, 20.0 * kPi) * (i % 2);
    joint.most = i == 0 ? 6.2 : uniform(random, 0.0, 20.0 * kPi);
    if (i == 0) joint.least = -1.0;  // passes 2π − 1
    joint.spring_stiffness = 0.1;
    SceneModel scene = onJoint(joint);
    BodyEnergy energy(scene, kPeriod_s);
    TickRecord seen;
    seen.body_count = 1;
    const auto stand = [&](double q) {
      const Pose pose = poseOn(*scene.bodies[0].joint, scene.bodies[0].pose, q);
      seen.bodies[0].position_m = Vec3::from(pose.translation_m);
      seen.bodies[0].orientation_xyzw = QuatXyzw::from(Eigen::Quaterniond(pose.rotation));
      energy.advance(seen, nullptr, 0, {});
      ASSERT_NEAR(energy.energy().held_j, 0.05 * q * q, 1e-9 + 1e-12 * q * q) << i;
    };
    const double step = 0.5;
    for (double q = 0.0; q < joint.most; q += step) ASSERT_NO_FATAL_FAILURE(stand(q));
    for (double q = joint.most; q > joint.least; q -= step) ASSERT_NO_FATAL_FAILURE(stand(q));
    ASSERT_NO_FATAL_FAILURE(stand(joint.least));
  }
}

TEST(BodyEnergy, SpinningBall_HoldsTheSameInAnyOrientation) {
  Watched w;
  w.state(0).angular_velocity_rad_s = {3.0, -4.0, 12.0};
  w.state(0).orientation_xyzw = QuatXyzw{0.5, 0.5, 0.5, 0.5};
  w.check();
  EXPECT_NEAR(w.held(), 0.5 * 0.4 * kMass_kg * kRadius_m * kRadius_m * 169.0, 1e-12);
}

TEST(BodyEnergy, BodyPushedByTheHand_GainsNothing) {
  // 3 N for a millisecond beside the centre: v = f T / m, ω = r × f T / I.
  Watched w;
  w.check();
  const Vec3 push_n{3.0, 0.0, 0.0};
  w.state(0).velocity_m_s.x = 3.0 * kPeriod_s / kMass_kg;
  w.state(0).velocity_m_s.z = -9.81 * kPeriod_s;
  w.state(0).angular_velocity_rad_s.z =
      -0.03 * 3.0 * kPeriod_s / (0.4 * kMass_kg * kRadius_m * kRadius_m);
  Contact& touch = w.touch(0);
  touch.point_m = {0.0, 0.03, 0.0};
  touch.force_n = {-push_n.x, 0.0, 0.0};  // force on the hand
  w.check();
  EXPECT_NEAR(w.gained(), 0.0, 1e-12);
  EXPECT_GT(w.held(), 1e-5);
}

TEST(BodyEnergy, EnergyOfAMotor_IsGained) {
  Watched w;
  w.check();
  w.state(0).velocity_m_s = {0.0, 2.0, -9.81 * kPeriod_s};
  w.check();
  EXPECT_NEAR(w.gained(), 0.5 * kMass_kg * 4.0, 1e-12);
  EXPECT_NEAR(w.received(), 0.5 * kMass_kg * 9.81 * 9.81 * kPeriod_s * kPeriod_s, 1e-12);
}

TEST(BodyEnergy, EnergyOfAnExercisesThrow_IsReceived) {
  Watched w;
  w.check();
  w.place(0, {0.2, 0.0, 1.0}, {0.0, 0.0, 3.0});
  w.state(0).velocity_m_s.z -= 9.81 * kPeriod_s;
  w.check();
  EXPECT_NEAR(w.gained(), 0.0, 1e-12);
  EXPECT_NEAR(w.received(), w.held(), 1e-12);
  // Catching the ball and putting it down gives no energy.
  w.place(0, {0.2, 0.0, 1.0}, {});
  w.state(0).velocity_m_s.z -= 9.81 * kPeriod_s;
  w.check();
  EXPECT_LE(w.received(), 1e-4);
  EXPECT_NEAR(w.gained(), 0.0, 1e-12);
}

TEST(BodyEnergy, WallMovedByAnExercise_GivesEnergyThroughTheHand) {
  Watched w;
  w.check();
  w.place(1, {0.5, 0.0, 0.0}, {-0.2, 0.0, 0.0});
  w.state(0).velocity_m_s = {-0.1, 0.0, -9.81 * kPeriod_s};  // it also pushes the ball
  w.touch(1).force_n = {-5.0, 1.0, 0.0};
  w.check();
  const double gravity_j = 0.5 * kMass_kg * 9.81 * 9.81 * kPeriod_s * kPeriod_s;
  EXPECT_NEAR(w.received(), gravity_j + 5.0 * 0.2 * kPeriod_s + 0.5 * kMass_kg * 0.01, 1e-12);
  EXPECT_EQ(w.gained(), 0.0);
}

TEST(BodyEnergy, BodyLaidToRest_LosesItsEnergyWithoutDebt) {
  Watched w;
  w.state(0).velocity_m_s.x = 1e-3;
  w.check();
  w.state(0).velocity_m_s = {};
  w.check();
  EXPECT_EQ(w.held(), 0.0);
  EXPECT_LE(w.gained(), 0.0);
}

TEST(BodyEnergy, BodiesOfAGame_GiveTheEnergyOfTheirPool) {
  Watched w;
  w.check({1.0, 5.0});
  EXPECT_EQ(w.received(), 0.0);  // before the first step
  w.state(0).velocity_m_s.z = -9.81 * kPeriod_s;
  w.check({3.0, 2.0});
  EXPECT_GE(w.received(), 2.0);
  EXPECT_NEAR(w.gained(), 0.0, 1e-12);
  w.check({3.5, 0.0});
  EXPECT_NEAR(w.gained(), 0.5, 1e-3);
}

TEST(BodyEnergy, NonFiniteState_GivesNonFiniteEnergy) {
  Watched w;
  w.check();
  w.state(0).velocity_m_s.x = std::nan("");
  w.check();
  EXPECT_FALSE(w.gained() <= 1.0);
}

// Two balls of random masses collide: contacts between bodies make no energy in any direction.
TEST(BodyEnergy, Impacts_NeverRaiseTheEnergy) {
  auto random = seededRandom(81);
  for (int i = 0; i < cases(200); ++i) {
    SceneModel scene;
    scene.gravity_m_s2.setZero();
    const double a_kg = uniform(random, 1e-3, 5.0), b_kg = uniform(random, 1e-3, 5.0);
    scene.bodies = {ball({}, 0.02, a_kg), ball({}, 0.02, b_kg)};
    BodyEnergy bodies(scene, kPeriod_s);
    TickRecord record;
    record.body_count = 2;
    const double v_a = uniform(random, 0.0, 15.0), v_b = uniform(random, -15.0, 0.0);
    record.bodies[0].velocity_m_s.x = v_a;
    record.bodies[1].velocity_m_s.x = v_b;
    bodies.advance(record, nullptr, 0, {});
    const double together = (a_kg * v_a + b_kg * v_b) / (a_kg + b_kg);
    record.bodies[0].velocity_m_s.x = record.bodies[1].velocity_m_s.x = together;
    bodies.advance(record, nullptr, 0, {});
    const double lost_j = 0.5 * a_kg * b_kg / (a_kg + b_kg) * (v_a - v_b) * (v_a - v_b);
    EXPECT_NEAR(bodies.gained_j(), -lost_j, 1e-9 * (1.0 + lost_j));
  }
}

}  // namespace
}  // namespace wholehand::test
