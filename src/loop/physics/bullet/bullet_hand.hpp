#pragma once

#include "loop/dynamics/articulated_body.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/physics/bullet/box_sweep.hpp"
#include "loop/physics/bullet/bullet_types.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>

#include <memory>
#include <vector>

namespace wholehand::bullet {

/// Pose of a capsule of the hand.
struct PlacedCapsule {
  Eigen::Vector3d a_m, b_m;  ///< ends of its segment, world
  double radius_m = 0.0;
  WorldBox box;
};

/// The hand in Bullet: plain collision objects, placed by our own kinematics, so that a link may
/// carry many capsules. Bullet does not integrate them.
class BulletHand {
 public:
  BulletHand(const HandModel& hand, double friction);

  [[nodiscard]] int count() const { return static_cast<int>(objects_.size()); }
  /// Updates every capsule from its link's pose. Real-time safe. @pre kinematics outlives this
  void placeCapsules(const ArticulatedBody& kinematics) noexcept;
  [[nodiscard]] const PlacedCapsule& placed(int capsule) const { return placed_[capsule]; }
  /// A capsule's shape, in the frame of its collision object.
  [[nodiscard]] const Shape& form(int capsule) const { return forms_[capsule]; }
  [[nodiscard]] bool isPalm(int capsule) const { return palm_[capsule]; }
  /// Bounding box of all capsules.
  [[nodiscard]] const WorldBox& box() const { return box_; }
  /// A capsule's collision object at its current pose. The pose is computed on demand, since most
  /// capsules are near nothing. Real-time safe.
  [[nodiscard]] btCollisionObject& object(int capsule) noexcept;

 private:
  void placeAll() noexcept;

  std::vector<std::unique_ptr<btCapsuleShapeZ>> shapes_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_;
  std::vector<Shape> forms_;
  std::vector<ColliderTag> tags_;
  std::vector<Capsule> capsules_;
  std::vector<Pose> capsule_in_link_;
  std::vector<PlacedCapsule> placed_;
  std::vector<bool> palm_;
  std::vector<bool> has_frame_;  ///< per capsule: its pose was computed since placeCapsules()
  const ArticulatedBody* kinematics_ = nullptr;
  WorldBox box_;
};

}  // namespace wholehand::bullet
