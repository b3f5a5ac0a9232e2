#pragma once

#include "physics/bullet/bullet_bodies.hpp"
#include "physics/bullet/bullet_hand.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <vector>

namespace wholehand::bullet {

/// Finds the contact points of all colliders. Which of them may ever meet is listed once; every
/// step looks at their boxes, and compares those whose boxes overlap. A capsule of the hand and a
/// box, sphere, cylinder or capsule have their nearest points from contactDistance(); a convex
/// mesh, and two bodies, are Bullet's own narrow phase. Bullet keeps the points from step to step
/// in either case. Real-time safe but for construction.
class ColliderPairs {
 public:
  /// @pre all outlive this @param threshold_m surfaces nearer than this are a contact point
  ColliderPairs(btCollisionDispatcher& dispatcher, BulletHand& hand,
                std::vector<BulletBody>& bodies, double threshold_m);
  ~ColliderPairs();
  ColliderPairs(const ColliderPairs&) = delete;
  ColliderPairs& operator=(const ColliderPairs&) = delete;

  /// Contact points where hand and bodies are now.
  void find() noexcept;

 private:
  using Collider = BulletBody::Collider;
  /// What is kept of two colliders while they are near.
  struct Pair {
    btPersistentManifold* manifold = nullptr;  ///< of two whose nearest points are ours
    btCollisionAlgorithm* algorithm = nullptr;
  };
  /// A collider of a body, and the hand's capsules that it may meet.
  struct Target {
    Collider* collider = nullptr;
    std::vector<int> capsules;
    std::vector<Pair> pairs;  ///< one a capsule
    int kept = 0;             ///< pairs that keep something
  };
  struct BodyPair {
    Collider *a = nullptr, *b = nullptr;
    Pair pair;
  };

  void findOfHand(Target& target) noexcept;
  void touch(int capsule, Collider& collider, Pair& pair) noexcept;
  void ask(Pair& pair, btCollisionObject& first, btCollisionObject& second) noexcept;
  void drop(Pair& pair) noexcept;

  btCollisionDispatcher& dispatcher_;
  BulletHand& hand_;
  const double threshold_m_;
  btDispatcherInfo info_;
  std::vector<Target> targets_;
  std::vector<BodyPair> body_pairs_;
};

}  // namespace wholehand::bullet
