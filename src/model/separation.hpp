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

}  // namespace wholehand
