#pragma once

#include "loop/core/geometry.hpp"
#include "loop/model/scene_model.hpp"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btVector3.h>

#include <memory>

namespace wholehand::bullet {

/// Contact threshold: surfaces nearer than this make a contact point; boxes are padded by it [m].
/// Bullet keeps it in a global variable, so it is one constant, which the first call sets.
[[nodiscard]] double contactThreshold();

/// Bullet's frame of a body: centre of mass, principal axes. A diagonal inertia keeps its axes, so
/// that a box is not rotated by 90 degrees.
/// @param moments of inertia about these axes; 0 for a fixed body
[[nodiscard]] Pose principalFrame(const SceneBody& body, btVector3& moments);

/// Creates the shape in its own frame.
[[nodiscard]] std::unique_ptr<btCollisionShape> makeShape(const Shape& shape);

}  // namespace wholehand::bullet
