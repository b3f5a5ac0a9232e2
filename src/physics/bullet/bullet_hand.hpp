#pragma once

#include "dynamics/articulated_body.hpp"
#include "model/hand_model.hpp"
#include "physics/bullet/collider_tag.hpp"
#include "physics/bullet/world_box.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>

#include <memory>
#include <vector>

namespace wholehand::bullet {

/// Where a capsule of the hand is.
struct PlacedCapsule {
  Eigen::Vector3d a_m, b_m;  ///< ends of its segment, world
  double radius_m = 0.0;
  WorldBox box;
};

/// The hand in Bullet: capsules that touch. They are plain collision objects placed by our own
/// kinematics, so that a link may carry many; Bullet integrates none of them.
class BulletHand {
 public:
  BulletHand(const HandModel& hand, double friction);

  [[nodiscard]] int count() const { return static_cast<int>(objects_.size()); }
  /// Moves every capsule to its link. Real-time safe. @pre kinematics outlives this
  void placeCapsules(const ArticulatedBody& kinematics) noexcept;
  [[nodiscard]] const PlacedCapsule& placed(int capsule) const { return placed_[capsule]; }
  [[nodiscard]] bool isPalm(int capsule) const { return palm_[capsule]; }
  /// Holds all capsules.
  [[nodiscard]] const WorldBox& box() const { return box_; }
  /// A capsule as Bullet sees it, at its place. Most are near nothing, so that only who asks pays
  /// for the frame. Real-time safe.
  [[nodiscard]] btCollisionObject& object(int capsule) noexcept;

 private:
  std::vector<std::unique_ptr<btCapsuleShapeZ>> shapes_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_;
  std::vector<ColliderTag> tags_;
  std::vector<Capsule> capsules_;
  std::vector<Pose> capsule_in_link_;
  std::vector<PlacedCapsule> placed_;
  std::vector<bool> palm_;
  std::vector<bool> has_frame_;  ///< since placeCapsules()
  const ArticulatedBody* kinematics_ = nullptr;
  WorldBox box_;
};

}  // namespace wholehand::bullet
