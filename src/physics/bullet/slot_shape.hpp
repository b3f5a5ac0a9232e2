#pragma once

#include "model/scene/scene_model.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <LinearMath/btTransform.h>

#include <variant>

namespace wholehand::bullet {

/// A piece of a game's body, in the frame of the rigid body.
struct SlotPiece {
  ShapeType type = ShapeType::kBox;
  Eigen::Vector3d half_extents_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0, length_m = 0.0;
  btTransform in_rigid = btTransform::getIdentity();
  btVector3* vertices = nullptr;  ///< of a convex mesh; outlive every use of the piece
  int vertex_count = 0;
};

/// A shape that is made in place: no allocation. Real-time safe.
class SlotShape {
 public:
  /// Replaces the shape; the one before is no longer in use.
  btCollisionShape* make(const SlotPiece& piece) noexcept;

 private:
  std::variant<std::monostate, btBoxShape, btSphereShape, btCylinderShapeZ, btCapsuleShapeZ,
               btConvexPointCloudShape>
      shape_;
};

}  // namespace wholehand::bullet
