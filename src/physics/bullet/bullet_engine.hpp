#pragma once

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"
#include "model/scene_model.hpp"
#include "physics/bullet/bullet_bodies.hpp"
#include "physics/bullet/bullet_hand.hpp"
#include "physics/bullet/collider_pairs.hpp"
#include "physics/bullet/reduced_contact_solver.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>

#include <string>
#include <vector>

namespace wholehand::bullet {

/// What a world is made of: Bullet's shapes, contact points and solver, with the hand and the
/// scene's bodies in them. Built and rehearsed here; BulletWorld steps it.
struct BulletEngine {
  /// Builds everything, then rehearses: no later step allocates. @pre hand outlives this
  BulletEngine(const HandModel& hand, const SceneModel& scene, const SolverSettings& settings);
  BulletEngine(const BulletEngine&) = delete;
  BulletEngine& operator=(const BulletEngine&) = delete;

  /// One step of the bodies, and of the hand's reduced velocities by its contacts.
  /// @pre the solver was told of the step. Real-time safe.
  void advance(double step_s) noexcept;
  /// Puts the hand there: joints and capsules follow. Real-time safe.
  void setHand(const AxisPosition& position, const AxisVelocity& velocity) noexcept;
  /// Drops every contact point with the impulses it remembers, of one body or of all (-1).
  /// Real-time safe.
  void forgetContacts(int body = -1) noexcept;
  /// The deepest overlap of each body with the hand, where all are now.
  [[nodiscard]] Diagnostics overlaps();

  const HandModel& hand_model;
  Synergy synergy;
  ArticulatedBody kinematics;
  std::string scene_path;
  std::vector<std::string> body_names;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  HandRows rows;
  ReducedContactSolver solver;
  BulletHand hand;
  std::vector<BulletBody> bodies;
  ColliderPairs pairs;
  AxisPosition q_s;  ///< where setHand() last put the hand
  AxisVelocity qd_s;
  JointPosition theta;
  JointVelocity theta_dot;
  double period_s = 1e-3;

 private:
  void configure(const SolverSettings& settings);
  void rehearseManifolds();
  void rehearseStep();

  btContactSolverInfo solver_info_;
  std::vector<btRigidBody*> moving_;                ///< bodies that forces move
  std::vector<btCollisionObject*> moving_objects_;  ///< the same, as the solver takes them
};

}  // namespace wholehand::bullet
