#include "physics/bullet/slot_shape.hpp"

#include "physics/bullet/bullet_types.hpp"

namespace wholehand::bullet {

btCollisionShape* SlotShape::make(const SlotPiece& piece) noexcept {
  switch (piece.type) {
    case ShapeType::kBox:
      return &shape_.emplace<btBoxShape>(toBt(piece.half_extents_m));
    case ShapeType::kSphere:
      return &shape_.emplace<btSphereShape>(piece.radius_m);
    case ShapeType::kCylinder:
      return &shape_.emplace<btCylinderShapeZ>(
          btVector3(piece.radius_m, piece.radius_m, piece.length_m / 2.0));
    case ShapeType::kCapsule:
      return &shape_.emplace<btCapsuleShapeZ>(piece.radius_m, piece.length_m);
    case ShapeType::kConvexMesh: {
      auto& cloud = shape_.emplace<btConvexPointCloudShape>();
      // The default margin would swell the mesh by 4 cm; it comes first, since the box includes it.
      cloud.setMargin(0.0);
      cloud.setPoints(piece.vertices, piece.vertex_count);
      return &cloud;
    }
  }
  return nullptr;
}

}  // namespace wholehand::bullet
