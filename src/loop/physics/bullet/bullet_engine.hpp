#pragma once

#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/bullet/bullet_bodies.hpp"
#include "loop/physics/bullet/bullet_chains.hpp"
#include "loop/physics/bullet/bullet_hand.hpp"
#include "loop/physics/bullet/collider_pairs.hpp"
#include "loop/physics/bullet/game_bodies.hpp"
#include "loop/physics/bullet/reduced_contact_solver.hpp"
#include "loop/physics/bullet/resting_bodies.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>

#include <string>
#include <vector>

namespace wholehand::bullet {

/// Contents of a world: Bullet's shapes, contact points and solver, the hand and the scene's
/// bodies. Built and warmed up here; BulletWorld steps it.
struct BulletEngine {
  /// Builds everything and runs warm-up steps, so that later steps do not allocate. @pre hand
  /// outlives this
  BulletEngine(const HandModel& hand, const SceneModel& scene, const SolverSettings& settings);
  BulletEngine(const BulletEngine&) = delete;
  BulletEngine& operator=(const BulletEngine&) = delete;

  /// Advances the bodies, and applies contacts to the hand's reduced velocities, by one step.
  /// @pre the solver's beginStep() was called. Real-time safe.
  void advance(double step_s) noexcept;
  /// Sets position and velocity of the hand; updates joints and capsules. Real-time safe.
  void setHand(const AxisPosition& position, const AxisVelocity& velocity) noexcept;
  /// Deletes the contact points and their stored impulses of one body, or of all (-1). Real-time
  /// safe.
  void forgetContacts(int body = -1) noexcept;
  /// Call before every step. Fixed bodies that were not placed since the last step get zero
  /// velocity. Real-time safe.
  void beginStep() noexcept;
  /// States of the recorded bodies. Real-time safe.
  [[nodiscard]] const std::vector<BodyState>& bodyStates() noexcept;
  /// Updates the stored state of a body that was placed or begins to rest. Real-time safe.
  void updateState(int body) noexcept;
  /// Number of collider pairs of the last step that exceeded the capacity.
  [[nodiscard]] int dropped() const noexcept { return pairs.dropped() + unsolved_; }
  /// Deepest overlap of each body with the hand, at their current poses.
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
  std::vector<int> on_joints;  ///< recorded bodies on joints
  RestingBodies resting;
  BulletChains chains;
  ColliderPairs pairs;
  GameBodies game;   ///< manages the last bodies of `bodies`
  AxisPosition q_s;  ///< position last set by setHand()
  AxisVelocity qd_s;
  JointPosition theta;
  JointVelocity theta_dot;
  double period_s = 1e-3;

 private:
  void configure(const SolverSettings& settings);
  void rehearseManifolds();
  void rehearseStep();
  void putStableBodiesToSleep();
  void listMoving() noexcept;
  void findTouchedJoints() noexcept;
  void moveBodies(double step_s) noexcept;

  btContactSolverInfo solver_info_;
  std::vector<BulletBody*> moving_;                 ///< awake bodies
  std::vector<btCollisionObject*> moving_objects_;  ///< the same, in the solver's type
  std::vector<btPersistentManifold*> manifolds_;    ///< contacts of the hand or of an awake body
  std::vector<char> touched_;  ///< per body: a contact may act on it; empty without joints
  int unsolved_ = 0;
  bool listed_ = false;  ///< the lists above match the two versions below
  unsigned pairs_listed_ = 0, resting_listed_ = 0, game_listed_ = 0;
  unsigned game_shown_ = 0;        ///< version of the game's bodies in states_
  std::vector<int> fixed_;         ///< indices of the scene's fixed bodies
  std::vector<BodyState> states_;  ///< recorded bodies; awake ones as of the last bodyStates()
};

}  // namespace wholehand::bullet
