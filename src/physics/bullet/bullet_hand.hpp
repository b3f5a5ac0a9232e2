#pragma once

#include "dynamics/articulated_body.hpp"
#include "model/hand_model.hpp"
#include "physics/bullet/collider_tag.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>

#include <memory>
#include <vector>

namespace wholehand::bullet {

/// The hand in Bullet: capsules that touch. They are plain collision objects placed by our own
/// kinematics, so that a link may carry many; Bullet integrates none of them.
class BulletHand {
 public:
  BulletHand(const HandModel& hand, double friction);

  [[nodiscard]] const std::vector<std::unique_ptr<btCollisionObject>>& capsules() const {
    return objects_;
  }
  /// Moves every capsule to its link. Real-time safe.
  void placeCapsules(const ArticulatedBody& kinematics) noexcept;

 private:
  std::vector<std::unique_ptr<btCapsuleShapeZ>> shapes_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_;
  std::vector<ColliderTag> tags_;
  std::vector<Pose> capsule_in_link_;
};

}  // namespace wholehand::bullet
