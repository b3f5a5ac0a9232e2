#pragma once

#include "loop/physics/bullet/box_sweep.hpp"
#include "loop/physics/bullet/bullet_bodies.hpp"
#include "loop/physics/bullet/bullet_hand.hpp"
#include "loop/physics/bullet/contact_patch.hpp"
#include "loop/physics/bullet/resting_bodies.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <vector>

namespace wholehand::bullet {

/// Finds the contact points of all colliders. Each step compares the hand with the colliders in a
/// list of those around it. This list is renewed when the hand leaves the enlarged box of its last
/// list. For pairs of bodies, bounding boxes are swept along x, and pairs whose boxes overlap are
/// compared; at least one body of a pair must be awake. A resting body wakes when the hand or an
/// awake body comes near. contactDistance() handles a capsule or a sphere against a box, sphere,
/// cylinder or capsule; findPatch() handles all other pairs. Every step finds the points anew and
/// keeps their impulses. Points include those as far apart as two bodies may move in a step, so
/// that nothing passes through. Real-time safe except for construction.
class ColliderPairs {
 public:
  /// @pre all outlive this @param threshold_m surfaces nearer than this make a contact point
  ColliderPairs(btCollisionDispatcher& dispatcher, BulletHand& hand,
                std::vector<BulletBody>& bodies, RestingBodies& resting, double threshold_m);
  ~ColliderPairs();
  ColliderPairs(const ColliderPairs&) = delete;
  ColliderPairs& operator=(const ColliderPairs&) = delete;

  /// Updates the contact points for the current poses of hand and bodies. @param step_s duration of
  /// the coming step
  void find(double step_s) noexcept;
  /// Like find(), for pairs of bodies only.
  void findOfBodies(double step_s) noexcept;
  /// Call after a body was placed. Wakes the bodies near its former and its new pose.
  void placed(int body) noexcept;
  /// Updates the boxes of a body that was moved outside a step. Wakes no body.
  void moved(int body) noexcept;
  /// Removes the kept data of all pairs of a body and updates its boxes: the body takes other
  /// shapes or leaves the world. Wakes no body.
  void forget(int body) noexcept;
  /// Pairs of bodies whose boxes overlap.
  [[nodiscard]] const std::vector<RestingBodies::Near>& near() noexcept;
  /// Changes with every pair that is added or removed.
  [[nodiscard]] unsigned version() const noexcept { return version_; }
  /// Number of pairs of the last step that exceeded the capacity.
  [[nodiscard]] int dropped() const noexcept { return dropped_; }

 private:
  using Collider = BulletBody::Collider;
  /// Manifold of a pair that touches; null for other pairs.
  using Pair = btPersistentManifold*;
  /// Sphere-swept segment, world frame.
  struct Round {
    Eigen::Vector3d a_m, b_m;
    double radius_m = 0.0;
  };
  /// A collider of a body, and the hand's capsules that may touch it.
  struct Target {
    Collider* collider = nullptr;
    std::vector<int> capsules;
    std::vector<Pair> pairs;  ///< one per capsule
    int kept = 0;             ///< pairs with kept data
    /// The pair with a capsule of the hand; null when none is kept.
    [[nodiscard]] Pair pairWith(int capsule) const noexcept;
  };
  /// Two colliders of bodies whose boxes overlap; the lower index first.
  struct BodyPair {
    int a = -1, b = -1;
    Pair pair = nullptr;
  };

  void refreshBoxes() noexcept;
  void listAround() noexcept;
  void findOfHand(Target& target) noexcept;
  void removeInnerEdges() noexcept;
  void removeInnerEdgesOfBodies() noexcept;
  [[nodiscard]] bool ofOneSurface(int a, int b) const noexcept;
  void disturbNear() noexcept;
  void listOverlaps() noexcept;
  [[nodiscard]] BoxSweep::Part partOf(int collider) const noexcept;
  void follow() noexcept;
  [[nodiscard]] bool awake(int collider) const noexcept;
  /// The swept segment of a sphere or capsule.
  [[nodiscard]] static Round roundOf(const btCollisionObject& object, const Shape& form) noexcept;
  [[nodiscard]] static ContactPatch patchOf(const Round& round, const Collider& collider,
                                            double reach_m) noexcept;
  [[nodiscard]] double reach(const Collider& a, const Collider* b) const noexcept;
  void meet(Collider& a, Collider& b, Pair& pair) noexcept;
  void keep(const ContactPatch& patch, const btCollisionObject& first,
            const btCollisionObject& second, Pair& pair) noexcept;
  void drop(Pair& pair) noexcept;

  btCollisionDispatcher& dispatcher_;
  BulletHand& hand_;
  const double threshold_m_;
  double step_s_ = 0.0;
  RestingBodies& resting_;
  std::vector<Target> targets_;  ///< one per collider
  /// Per body: its first collider and the one after its last.
  std::vector<std::pair<int, int>> of_body_;
  std::vector<WorldBox> boxes_;        ///< box of every collider
  const std::vector<int> owner_;       ///< body of every collider
  std::vector<bool> meets_bodies_;     ///< per collider: it collides with other bodies
  WorldBox around_;                    ///< the hand's box at the last list, enlarged
  bool around_listed_ = false;         ///< the list below holds for the current boxes
  std::vector<int> around_colliders_;  ///< colliders within around_, ascending
  std::vector<bool> is_around_;        ///< per collider: listed in around_colliders_
  std::vector<int> touched_;           ///< colliders that the hand may touch
  BoxSweep sweep_;                     ///< overlaps of this step
  std::vector<BoxSweep::Part> parts_;  ///< per collider, for the version parts_version_ of resting_
  unsigned parts_version_ = ~0U;
  std::vector<BodyPair> body_pairs_, before_;  ///< kept pairs, ascending
  /// Pairs of each collider with pieces of a surface, ascending by collider.
  std::vector<BodyPair> met_;
  std::vector<RestingBodies::Near> near_;
  int dropped_ = 0;
  unsigned version_ = 0;
};

}  // namespace wholehand::bullet
