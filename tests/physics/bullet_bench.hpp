#pragma once

#include "physics/bullet/bullet_world.hpp"
#include "support/rig_tools.hpp"

/// A Bullet world with the shipped hand, stepped without device or renderer.
namespace wholehand::test {

inline constexpr double kPeriod_s = 1e-3;

inline WorldState look(PhysicsWorld& world, const WorldQuery& query = {}) {
  WorldState state;
  EXPECT_EQ(world.observe(query, state), Fault::kNone);
  return state;
}

/// A hand, driven by Eq. (2) towards a moving target, in a scene made in place.
struct Bench {
  explicit Bench(SceneModel scene_in, const std::string& hand = "adult-median-right")
      : models(load(shippedFiles("lambda-pride", "empty", hand))), scene(std::move(scene_in)) {
    world = std::make_unique<BulletWorld>(models.hand, scene);
  }
  /// One step towards q_m with the velocity qd_m.
  void step(const AxisPosition& q_m, const AxisVelocity& qd_m) {
    state = look(*world, query);
    ASSERT_TRUE(body.update(state.theta, state.theta_dot, scene.gravity_m_s2));
    AxisEffort f_s(q_m.size());
    for (int a = 0; a < f_s.size(); ++a) {
      f_s[a] = body.reducedInertia()(a, a) *
               (4e3 * (q_m[a] - state.q_s[a]) + 120.0 * (qd_m[a] - state.qd_s[a]));
    }
    HandDrive drive;
    body.distribute(f_s, drive.torque);
    drive.reduced_inertia_inverse = &body.reducedInertiaInverse();
    ASSERT_EQ(world->step(drive, kPeriod_s), Fault::kNone);
    world->contacts(touching);
    after = look(*world, query);
  }

  Models models;
  SceneModel scene;
  WorldQuery query;
  std::unique_ptr<BulletWorld> world;
  ArticulatedBody body{models.hand};
  WorldState state, after;
  ContactList touching;
};

inline SceneModel weightless(std::vector<SceneBody> bodies) {
  SceneModel scene;
  scene.gravity_m_s2.setZero();
  scene.bodies = std::move(bodies);
  return scene;
}

}  // namespace wholehand::test
