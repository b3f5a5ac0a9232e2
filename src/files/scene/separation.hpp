#pragma once

#include "loop/core/geometry.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

namespace wholehand {

/// Signed distance between two convex shapes [m]: positive when apart, 0 when touching, negative
/// penetration depth (least separating translation) when overlapping. `body_a`, `body_b` are the
/// poses of the body frames in the world.
///
/// Spheres and capsules are handled exactly, as a point or segment with a radius. Polyhedra are
/// exact to rounding; nearest points on a cylinder's rim are within 1 µm. For checks at load: not
/// real-time safe.
[[nodiscard]] double separation(const Shape& a, const Pose& body_a, const Shape& b,
                                const Pose& body_b);

/// Smallest separation between the shapes of `a` and of `b` in their initial poses [m].
[[nodiscard]] double separation(const SceneBody& a, const SceneBody& b);

}  // namespace wholehand
