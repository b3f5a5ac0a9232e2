#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace wholehand {

/// Maximum number of vertices of a convex mesh. Engines search all of them in every contact.
inline constexpr int kMaxMeshPoints = 1024;

/// Makes a collider from triangles and verifies that it is closed and convex: vertices nearer than
/// 1e-6 of the mesh's size are merged; it has volume; every vertex lies within 1e-4 of the size
/// inside every face's plane; every edge joins two faces. Any winding is accepted and made outward.
///
/// @return the shape, or one Diagnostic with problem and remedy (file and key are the caller's).
[[nodiscard]] Expected<Shape> convexMesh(const std::vector<Eigen::Vector3d>& points_m,
                                         const std::vector<Eigen::Vector3i>& triangles);

/// Maximum number of triangles of a mesh file.
inline constexpr int kMaxMeshTriangles = 200'000;

class MeshLoadTime;  // files/mesh/mesh_file.hpp
struct MeshFile;     // files/mesh/mesh_file.hpp
struct MeshSurface;  // files/mesh/mesh_file.hpp

/// Converts a surface to a collider. @pre the surface is convex, closed and wound outward
[[nodiscard]] Shape shapeOf(const MeshSurface& surface);

/// The collider of a mesh.
struct MeshCollider {
  std::vector<Shape> shapes;  ///< one, or one for each convex part
  Diagnostics notices;        ///< why and how `shapes` differ from the mesh; empty: no difference
};

/// Makes colliders from a mesh file. A convex mesh becomes one shape by convexMesh(). A mesh whose
/// parts are all convex becomes one shape for each part; a part is an object, group or solid of the
/// file, else a connected piece, and counts as convex when its hull is at most 5 % larger in
/// volume. A part inside another part is left out, unless it is wound the opposite way: then it is
/// a hollow, and the mesh is not convex. Any other mesh is replaced by its convex hull
/// (convexHull()). A hull of more than 2 kMaxMeshPoints triangles keeps kMaxMeshPoints corners.
/// Notices say how much the volume differs.
///
/// @return the collider, or one Diagnostic with problem and remedy: no faces, no volume, not 0.001
/// to 10 m across, more than kMaxMeshTriangles.
[[nodiscard]] Expected<MeshCollider> meshCollider(const MeshFile& file);

/// Reads a mesh file (STL, OBJ, PLY, DAE, GLB) and makes a collider of it. Coordinates times
/// `scale` are metres; axes are taken as in the file (the up axis of DAE and GLB is ignored, with a
/// notice). A child process (meshReaderProgram()) reads the file; without that program, this
/// process does (docs/adr/0027-untrusted-files-in-child-processes.md).
///
/// @return the same as meshCollider(), with the path in problem and notices; also a Diagnostic when
/// the file is missing or unreadable.
[[nodiscard]] Expected<MeshCollider> loadMeshCollider(const std::string& path,
                                                      const Eigen::Vector3d& scale);
/// The same for one of several meshes; its reading time is added to `time`.
/// @return also a Diagnostic when that time is used up
[[nodiscard]] Expected<MeshCollider> loadMeshCollider(const std::string& path,
                                                      const Eigen::Vector3d& scale,
                                                      MeshLoadTime& time);

}  // namespace wholehand
