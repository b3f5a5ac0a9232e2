#pragma once

#include "core/tick_record.hpp"
#include "model/scene_model.hpp"
#include "physics/bullet/collider_tag.hpp"
#include "physics/bullet/world_box.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <memory>
#include <vector>

namespace wholehand::bullet {

/// A body of the scene in Bullet: a rigid body that moves and has no shape, and colliders that
/// touch. Bullet's body frame is the principal frame of inertia at the centre of mass.
class BulletBody {
 public:
  /// At its starting pose. @param index in the scene @param reach_m by which the colliders' boxes
  /// are larger than they are
  BulletBody(const SceneBody& body, int index, double reach_m);

  [[nodiscard]] btRigidBody& rigid() { return *rigid_; }
  /// Whether forces move it; a fixed one is only placed.
  [[nodiscard]] bool moves() const { return !rigid_->isStaticObject(); }
  /// What a collider collides with: of a soft body the digits meet the core, all else the shape.
  enum class Meets { kAll, kAllButDigits, kDigits };
  struct Collider {
    Meets meets = Meets::kAll;
    Shape form;  ///< in the collider's own frame
    ColliderTag tag;
    std::unique_ptr<btCollisionShape> shape;
    std::unique_ptr<btCollisionObject> object;
    btTransform in_rigid;
    WorldBox box;
  };
  [[nodiscard]] const std::vector<std::unique_ptr<Collider>>& colliders() const {
    return colliders_;
  }

  /// Moves the colliders to the rigid body. Real-time safe.
  void placeColliders() noexcept;
  /// Puts it where an exercise wants it; it no longer turns. A fixed body has the velocity given
  /// for the coming step only. Where the placement is no pose it stays. Gives whether it was put
  /// elsewhere, farther than it could slide with its contacts. Real-time safe.
  bool place(const BodyPlacement& placement) noexcept;
  /// Before every step: a fixed body that was not placed since the last one stands. Real-time safe.
  void beginStep() noexcept;
  /// Back to the starting pose, at rest.
  void putAtStart() noexcept;
  /// Centre of mass and the orientation of the scene's body frame. Real-time safe.
  [[nodiscard]] BodyState state() const noexcept;

 private:
  void put(const btTransform& at, const btVector3& velocity) noexcept;
  void addCollider(const SceneBody& body, const Shape& shape, Meets meets);

  Pose from_body_;     ///< Bullet's frame in the scene's body frame
  btTransform start_;  ///< of Bullet's frame
  std::unique_ptr<btCollisionShape> no_shape_;
  std::unique_ptr<btRigidBody> rigid_;
  int index_;
  double reach_m_;
  bool placed_ = false;
  std::vector<std::unique_ptr<Collider>> colliders_;  ///< tags are pointed to: addresses stay
};

}  // namespace wholehand::bullet
