#pragma once

#include "lab/bullet_paper/paper_body.hpp"
#include "lab/bullet_paper/paper_hand.hpp"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <deque>
#include <string>
#include <vector>

namespace wholehand::bullet_paper {

/// Bullet's dispatcher with the stock contact threshold, independent of the value that another
/// engine has set in Bullet's global variable.
class PaperDispatcher final : public btCollisionDispatcher {
 public:
  using btCollisionDispatcher::btCollisionDispatcher;
  btPersistentManifold* getNewManifold(const btCollisionObject* a,
                                       const btCollisionObject* b) override;
};

/// Bullet's solver with preallocated arrays.
class PaperSolver final : public btMultiBodyConstraintSolver {
 public:
  explicit PaperSolver(int dofs);
};

/// One complete stock Bullet world. The constructor builds it and warms it up.
struct PaperEngine {
  /// @pre hand outlives this
  PaperEngine(const HandModel& hand, const SceneModel& scene, PaperCoupling coupling);
  ~PaperEngine();
  PaperEngine(const PaperEngine&) = delete;
  PaperEngine& operator=(const PaperEngine&) = delete;

  WHOLEHAND_RT void setHand(const AxisPosition& position, const AxisVelocity& velocity) noexcept;
  /// Deletes the contact points of one body, or of all (-1).
  WHOLEHAND_RT void forgetContacts(int body = -1) noexcept;
  /// Deepest overlap of each body with the hand, at their current poses.
  [[nodiscard]] Diagnostics overlaps();

  const HandModel& hand_model;
  Synergy synergy;
  std::string scene_path;
  std::vector<std::string> body_names;
  std::deque<PaperBody>
      bodies;  ///< addresses must not change, because Bullet keeps pointers to the tags
  PaperHand hand;
  btDefaultCollisionConfiguration configuration;
  PaperDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  PaperSolver solver;
  btMultiBodyDynamicsWorld world;
  AxisPosition q_s;  ///< position last set by setHand()
  AxisVelocity qd_s;
  double coupling_error_rad = 0.0;
  double period_s = 1e-3;

 private:
  void configure(const SceneModel& scene);
  void rehearse();
};

}  // namespace wholehand::bullet_paper
