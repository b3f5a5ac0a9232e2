#pragma once

#include "core/expected.hpp"
#include "model/mesh/mesh_surface.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Convex hull of points, by Qhull: its corners, and its faces as triangles wound outward. The
/// order of both depends only on the points.
///
/// @pre every coordinate is finite
/// @return the hull, or one Diagnostic with problem and remedy: fewer than four points, or all
/// within 1e-6 of their extent of one plane.
[[nodiscard]] Expected<MeshSurface> convexHull(const std::vector<Eigen::Vector3d>& points);

}  // namespace wholehand
