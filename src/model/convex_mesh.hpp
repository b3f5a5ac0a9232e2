#pragma once

#include "core/expected.hpp"
#include "model/scene_model.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace wholehand {

/// The most corners a convex mesh may have: engines search all of them in every contact.
inline constexpr int kMaxMeshPoints = 1024;

/// Makes a collider of triangles and proves that it is one: corners nearer to each other than 1e-6
/// of the mesh's size are one; it has volume; every corner lies within 1e-4 of the size inside
/// every face's plane; every edge joins two faces. The winding may be anything and comes out
/// outward.
///
/// @return the shape, or one Diagnostic with problem and remedy (file and key are the caller's).
[[nodiscard]] Expected<Shape> convexMesh(const std::vector<Eigen::Vector3d>& points_m,
                                         const std::vector<Eigen::Vector3i>& triangles);

/// Reads a mesh file (STL, OBJ, DAE, GLB) whose coordinates times `scale` are metres, with the
/// axes as they stand in the file (a DAE's up-axis tag is not applied), and makes a collider of it.
/// The file is read in a process of its own (meshReaderProgram()); in this one where there is none
/// (docs/adr/0027-children-read-strangers-files.md).
///
/// @return as convexMesh(); also where the file is missing, unreadable or has no faces.
[[nodiscard]] Expected<Shape> loadConvexMesh(const std::string& path, const Eigen::Vector3d& scale);

}  // namespace wholehand
