#pragma once

#include "loop/physics/engine_bounds.hpp"
#include "loop/physics/hand_probe.hpp"
#include "rig/engines.hpp"
#include "support/constants.hpp"
#include "support/rig_tools.hpp"

/// A world of any engine with the shipped hand, stepped without device and renderer.
namespace wholehand::test {

inline PhysicsState look(PhysicsWorld& world) {
  PhysicsState state;
  EXPECT_EQ(world.observe(state), Fault::kNone);
  return state;
}

/// A hand driven by Eq. (2) towards a moving target, in a scene built by the test.
struct Bench {
  Bench(const std::string& engine, SceneModel scene_in,
        const std::string& hand = "adult-median-right")
      : models(load(shippedFiles("lambda-pride", "empty", hand))), scene(std::move(scene_in)) {
    world = orThrow(buildWorld(engine, models.hand, scene));
  }
  /// Adds armature to the axes from now on: A = share · diag(M_r) in the posture q_s.
  void addArmature(double share, const AxisPosition& q_s) {
    JointPosition theta;
    Synergy(models.hand).expand(q_s, theta);
    ASSERT_TRUE(body.update(theta, JointVelocity(models.hand.joint_count), scene.gravity_m_s2));
    armature = AxisInertia(q_s.size());
    for (int a = 0; a < armature.size(); ++a) armature[a] = share * body.reducedInertia()(a, a);
    body = ArticulatedBody(models.hand, armature);
  }
  /// Runs one step towards q_m with the velocity qd_m.
  void step(const AxisPosition& q_m, const AxisVelocity& qd_m) {
    state = look(*world);
    ASSERT_TRUE(body.update(state.theta, state.theta_dot, scene.gravity_m_s2));
    AxisEffort f_s(q_m.size());
    for (int a = 0; a < f_s.size(); ++a) {
      f_s[a] = body.reducedInertia()(a, a) *
               (4e3 * (q_m[a] - state.q_s[a]) + 120.0 * (qd_m[a] - state.qd_s[a]));
    }
    asked = f_s;
    HandDrive drive;
    drive.effort = f_s;
    body.distribute(f_s, drive.torque);
    drive.armature = armature;
    drive.armature_effort = body.armatureEffort(f_s);
    drive.reduced_inertia_inverse = &body.reducedInertiaInverse();
    ASSERT_EQ(world->step(drive, period_s) & kStoppingFaults, Fault::kNone);
    world->contacts(touching);
    after = look(*world);
    ask(query);
  }
  /// Runs the probe's queries on the world's present state.
  const TickRecord& ask(const WorldQuery& about) {
    const PhysicsState now = look(*world);
    kinematics.updateKinematics(now.theta);
    probed.theta = now.theta;
    probed.q_s = now.q_s;
    std::copy_n(now.bodies.begin(), now.body_count, probed.bodies.begin());
    probe.look(&kinematics.linkPose(0), about, probed);
    return probed;
  }

  Models models;
  SceneModel scene;
  WorldQuery query;
  std::unique_ptr<PhysicsWorld> world;
  AxisInertia armature;
  ArticulatedBody body{models.hand}, kinematics{models.hand};
  HandProbe probe{models.hand, scene};
  TickRecord probed;
  PhysicsState state, after;
  ContactList touching;
  AxisEffort asked;  ///< f_s of the last step
  double period_s = kPeriod_s;
};

inline SceneModel weightless(std::vector<SceneBody> bodies) {
  SceneModel scene;
  scene.gravity_m_s2.setZero();
  scene.bodies = std::move(bodies);
  return scene;
}

/// Names of the engines that must satisfy the contact laws.
inline std::vector<std::string> enginesOfContactLaws() {
  std::vector<std::string> names = builtEngines();
  std::erase_if(names, [](const auto& name) { return !boundsOf(name).contact_laws; });
  return names;
}

inline RigOptions with(const std::string& engine) {
  RigOptions options;
  options.engine = engine;
  return options;
}

/// The engine's name as a valid test name.
inline std::string testName(std::string engine) {
  std::replace(engine.begin(), engine.end(), '-', '_');
  return engine;
}

/// A law of engines; its parameter is the engine's name.
class EngineTest : public testing::TestWithParam<std::string> {};

}  // namespace wholehand::test

/// Declares a suite of laws that every engine satisfies.
#define WHOLEHAND_ENGINES(suite)                                              \
  class suite : public EngineTest {};                                         \
  INSTANTIATE_TEST_SUITE_P(Engines, suite, testing::ValuesIn(builtEngines()), \
                           [](const auto& one) { return testName(one.param); })

/// Declares a suite of laws for pressed, grasped and sliding contacts (Bounds::contact_laws,
/// docs/engines.md).
#define WHOLEHAND_ENGINES_OF_CONTACT_LAWS(suite)                                      \
  class suite : public EngineTest {};                                                 \
  INSTANTIATE_TEST_SUITE_P(Engines, suite, testing::ValuesIn(enginesOfContactLaws()), \
                           [](const auto& one) { return testName(one.param); })
