#pragma once

#include "loop/core/body_order.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/game_shapes.hpp"
#include "loop/model/scene_model.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <Eigen/Geometry>
#include <LinearMath/btTransform.h>

#include <variant>
#include <vector>

namespace wholehand::bullet {

/// A piece of a game's body, in the frame of the rigid body.
struct SlotPiece : ShapeForm {
  btTransform in_rigid = btTransform::getIdentity();
  /// Vertices of a convex mesh; they outlive every use of the piece.
  btVector3* vertices = nullptr;
  int vertex_count = 0;
};

/// A shape that is constructed in place, without allocation. Real-time safe.
class SlotShape {
 public:
  /// Replaces the shape; the previous shape must no longer be in use.
  btCollisionShape* make(const SlotPiece& piece) noexcept;

 private:
  std::variant<std::monostate, btBoxShape, btSphereShape, btCylinderShapeZ, btCapsuleShapeZ,
               btConvexPointCloudShape>
      shape_;
};

/// Shape sets of a game, in memory that exists from the start. Several commands transfer a set, in
/// order; it can be used once it is complete. Real-time safe except for construction.
class ShapeSets {
 public:
  struct Set {
    int announced = 0;  ///< announced number of pieces; 0: the set is empty
    int pieces = 0;     ///< pieces begun so far
    int vertices = 0;   ///< vertices of the last piece so far
    int users = 0;      ///< number of bodies with these shapes
    btVector3 moments_per_kg{0, 0, 0};
    Eigen::Quaterniond from_body = Eigen::Quaterniond::Identity();
    /// Radius of the sphere about the centre of mass that contains all pieces.
    double radius_m = 0.0;
  };

  explicit ShapeSets(const GameBudget& budget);

  /// Applies a kShapeSet, kShapePiece or kShapeVertices command; a command that is refused empties
  /// its set.
  [[nodiscard]] BodyRefusal take(const Command& command) noexcept;
  /// The complete set; null when there is none.
  [[nodiscard]] Set* find(int set) noexcept;
  [[nodiscard]] const SlotPiece* piecesOf(int set) const noexcept {
    return pieces_.data() + set * most_pieces_;
  }
  void acquire(int set) noexcept { ++sets_[set].users; }
  void release(int set) noexcept { --sets_[set].users; }

 private:
  [[nodiscard]] BodyRefusal begin(int set, const ShapeSetHead& head) noexcept;
  [[nodiscard]] BodyRefusal addPiece(int set, const ShapePiece& in) noexcept;
  [[nodiscard]] BodyRefusal addVertices(int set, const ShapeVertices& in) noexcept;
  [[nodiscard]] bool lastPieceIsWhole(int set) const noexcept;
  [[nodiscard]] SlotPiece& piece(int set, int index) noexcept {
    return pieces_[set * most_pieces_ + index];
  }

  const int most_pieces_, most_vertices_;
  const double most_m_;
  std::vector<Set> sets_;
  std::vector<SlotPiece> pieces_;
  std::vector<btVector3> vertices_;
};

}  // namespace wholehand::bullet
