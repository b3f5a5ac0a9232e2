#pragma once

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"
#include "model/scene_model.hpp"
#include "physics/bullet/bullet_bodies.hpp"
#include "physics/bullet/bullet_hand.hpp"
#include "physics/bullet/near_filter.hpp"
#include "physics/bullet/reduced_contact_solver.hpp"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <string>
#include <vector>

namespace wholehand::bullet {

/// All that Bullet needs for one world: built, rehearsed and taken apart here; BulletWorld steps
/// it.
struct BulletEngine {
  /// Builds everything, then rehearses: no later step allocates. @pre hand outlives this
  BulletEngine(const HandModel& hand, const SceneModel& scene, const SolverSettings& settings);
  ~BulletEngine();
  BulletEngine(const BulletEngine&) = delete;
  BulletEngine& operator=(const BulletEngine&) = delete;

  /// Puts the hand there: joints and capsules follow. Real-time safe.
  void setHand(const AxisPosition& position, const AxisVelocity& velocity) noexcept;
  /// Drops every contact point with the impulses it remembers, of one body or of all (-1).
  /// Real-time safe.
  void forgetContacts(int body = -1) noexcept;
  /// The deepest overlap of each body with the hand, after collision detection.
  [[nodiscard]] Diagnostics overlaps();

  const HandModel& hand_model;
  Synergy synergy;
  ArticulatedBody kinematics;
  std::string scene_path;
  std::vector<std::string> body_names;
  btDefaultCollisionConfiguration configuration;
  NearFilter dispatcher;
  btDbvtBroadphase broadphase;
  HandRows rows;
  ReducedContactSolver solver;
  btDiscreteDynamicsWorld world;
  BulletHand hand;
  std::vector<BulletBody> bodies;
  AxisPosition q_s;  ///< where setHand() last put the hand
  AxisVelocity qd_s;
  JointPosition theta;
  JointVelocity theta_dot;
  double period_s = 1e-3;

 private:
  void configure(const SceneModel& scene, const SolverSettings& settings);
  void rehearsePairs();
  void rehearseManifolds();
  void rehearseStep();
  [[nodiscard]] std::vector<btCollisionObject*> colliders() const;
};

}  // namespace wholehand::bullet
