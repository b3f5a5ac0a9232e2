#pragma once

#include "core/geometry.hpp"
#include "model/scene_model.hpp"

#include <Eigen/Core>

namespace wholehand {

/// Signed distance between two convex shapes [m]: positive apart, 0 touching, negative the least
/// translation that parts them. `body_a`, `body_b` place the shapes' body frames in the world.
///
/// Spheres and capsules count as a point or a segment with a radius, so that they are exact;
/// between polyhedra exact to rounding; where a cylinder's rim is the nearest part, within 1 µm.
/// For checks at load: not real-time safe.
[[nodiscard]] double separation(const Shape& a, const Pose& body_a, const Shape& b,
                                const Pose& body_b);

/// The smallest separation between any shape of `a` and any shape of `b`, at their start poses [m].
[[nodiscard]] double separation(const SceneBody& a, const SceneBody& b);

/// A capsule between two points as a shape, e.g. one of the hand's: ends and radius [m], in the
/// frame that the pose given beside it to separation() places.
[[nodiscard]] Shape capsuleShape(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m,
                                 double radius_m);

}  // namespace wholehand
