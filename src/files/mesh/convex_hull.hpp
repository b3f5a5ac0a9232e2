#pragma once

#include "files/mesh/mesh_file.hpp"
#include "loop/core/expected.hpp"

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

/// Convex hull with at most `most_vertices` vertices. Vertices are input points rounded to floats,
/// the precision of an OBJ file. Starts with four extreme points and adds the point farthest
/// outside until `most_vertices` are taken or no point lies outside by more than 1e-5 of the
/// extent.
///
/// @pre most_vertices >= 4, points finite and not empty
/// @return the same as convexHull(). The order depends only on the input. Not real-time safe.
[[nodiscard]] Expected<MeshSurface> reducedHull(const std::vector<Eigen::Vector3d>& points_m,
                                                int most_vertices);

}  // namespace wholehand
