#pragma once

#include "loop/core/geometry.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/bullet/bullet_types.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <LinearMath/btVector3.h>

#include <memory>
#include <type_traits>

namespace wholehand::bullet {

/// Contact threshold: surfaces nearer than this make a contact point; boxes are padded by it [m].
/// Bullet keeps it in a global variable, so it is one constant, which the first call sets.
[[nodiscard]] double contactThreshold();

/// Bullet's frame of a body: centre of mass, principal axes. A diagonal inertia keeps its axes, so
/// that a box is not rotated by 90 degrees.
/// @param moments of inertia about these axes; 0 for a fixed body
[[nodiscard]] Pose principalFrame(const SceneBody& body, btVector3& moments);

/// Constructs the shape of a sum in its own frame by `make(std::type_identity<Shape>, dimensions
/// ..)`. Real-time safe if `make` is. @pre the form has no vertices
template <class Make>
auto constructSum(const ShapeForm& form, const Make& make) {
  const btVector3 half_m = toBt(form.halfBox());
  if (form.isCylinder()) return make(std::type_identity<btCylinderShapeZ>{}, half_m);
  if (!form.isRound()) return make(std::type_identity<btBoxShape>{}, half_m);
  if (form.coreBox().z() == 0.0) return make(std::type_identity<btSphereShape>{}, form.radius_m);
  return make(std::type_identity<btCapsuleShapeZ>{}, form.radius_m, form.length_m);
}

/// Creates the shape in its own frame.
[[nodiscard]] std::unique_ptr<btCollisionShape> makeShape(const Shape& shape);

}  // namespace wholehand::bullet
