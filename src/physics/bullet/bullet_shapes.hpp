#pragma once

#include "core/geometry.hpp"
#include "model/scene_model.hpp"

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <LinearMath/btVector3.h>

#include <memory>

namespace wholehand::bullet {

/// Surfaces nearer than this are a contact point; boxes are padded by as much [m]. Bullet keeps it
/// in one variable of the process, so it is one constant, set by the first call.
[[nodiscard]] double contactThreshold();

/// Frame in which Bullet sees the body: centre of mass, principal axes. Where the inertia is
/// diagonal already the axes stay, so that a box is a box and not a box turned by 90 degrees.
/// @param moments about these axes; 0 of a fixed body
[[nodiscard]] Pose principalFrame(const SceneBody& body, btVector3& moments);

/// The shape in its own frame.
[[nodiscard]] std::unique_ptr<btCollisionShape> makeShape(const Shape& shape);

}  // namespace wholehand::bullet
