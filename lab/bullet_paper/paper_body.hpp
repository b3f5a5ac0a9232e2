#pragma once

#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/core/world_query.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/bullet/bullet_types.hpp"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <memory>
#include <vector>

namespace wholehand::bullet_paper {

/// A scene body in Bullet: a rigid body with its shape. A fixed body is one kinematic body per
/// shape.
class PaperBody {
 public:
  /// Creates the body at its initial pose. @param index index in the scene
  PaperBody(const SceneBody& body, int index);

  struct Part {
    int group = 0;
    btTransform in_frame;
    btCollisionShape* shape = nullptr;
    std::unique_ptr<btRigidBody> rigid;
  };
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }

  /// Places the body and stops its rotation. An invalid placement is ignored. Returns true when the
  /// body loses its contacts.
  WHOLEHAND_RT bool place(const BodyPlacement& placement) noexcept;
  /// Call before a step: Bullet derives a kinematic body's velocity from its displacement.
  WHOLEHAND_RT void beginStep(double period_s) noexcept;
  /// Call after a step: fixed bodies stop until they are placed again.
  WHOLEHAND_RT void endStep() noexcept;
  /// Resets to the initial pose, at rest.
  void putAtStart() noexcept;
  /// Moves the body to any position, for warm-up.
  void putAt(const btVector3& origin) noexcept;
  WHOLEHAND_RT [[nodiscard]] BodyState state() const noexcept;

 private:
  void addFixedParts(const SceneBody& body);
  void addFreePart(const SceneBody& body, const btVector3& moments);
  void addPart(int group, const btTransform& in_frame, btCollisionShape* shape, double mass_kg,
               const btVector3& moments, double friction);
  btCollisionShape* keep(std::unique_ptr<btCollisionShape> shape);
  void put(const btTransform& at, const btVector3& velocity) noexcept;
  [[nodiscard]] const btTransform& frame() const noexcept;

  bool fixed_;
  bullet::ColliderTag tag_;  ///< Bullet keeps a pointer to it, so the body must not move in memory
  Pose from_body_;           ///< Bullet's frame in the scene's body frame
  btTransform start_, frame_;
  btVector3 velocity_{0, 0, 0};  ///< surface velocity of a fixed body in the next step
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<Part> parts_;
};

}  // namespace wholehand::bullet_paper
