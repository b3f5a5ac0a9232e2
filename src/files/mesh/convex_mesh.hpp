#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace wholehand {

/// Limit of a convex mesh's vertices: engines search all of them in every contact.
inline constexpr int kMaxMeshPoints = 1024;

/// Makes a collider from triangles and verifies that it is closed and convex: vertices nearer than
/// 1e-6 of the mesh's size are merged; it has volume; every vertex lies within 1e-4 of the size
/// inside every face's plane; every edge joins two faces. Any winding is accepted and made outward.
///
/// @return the shape, or one Diagnostic with problem and remedy (file and key are the caller's).
[[nodiscard]] Expected<Shape> convexMesh(const std::vector<Eigen::Vector3d>& points_m,
                                         const std::vector<Eigen::Vector3i>& triangles);

/// Limit of a mesh file's triangles.
inline constexpr int kMaxMeshTriangles = 200'000;

class MeshLoadTime;  // files/mesh/mesh_file.hpp
struct MeshFile;     // files/mesh/mesh_file.hpp
struct MeshSurface;  // files/mesh/mesh_file.hpp

/// The surface as a collider: convex, closed and turned outwards already.
[[nodiscard]] Shape shapeOf(const MeshSurface& surface);

/// The collider of a mesh.
struct MeshCollider {
  std::vector<Shape> shapes;  ///< one, or one for each convex part
  Diagnostics notices;        ///< why and how `shapes` differ from the mesh; empty: they do not
};

/// As convexMesh(). A mesh that is not convex becomes one shape for each part, when every part (an
/// object, group or solid of the file; else every connected piece) is convex; a hull 5 % larger
/// than its part is, too. A part inside another is left out; if it is wound the other way, it is a
/// hollow, and the mesh not convex. Otherwise its convex hull (convexHull()) takes its place. Of a
/// hull beyond 2 kMaxMeshPoints triangles, kMaxMeshPoints corners are kept. Notices say how much
/// the volume differs.
///
/// @return the collider, or one Diagnostic with problem and remedy: no faces, no volume, not 0.001
/// to 10 m across, more than kMaxMeshTriangles.
[[nodiscard]] Expected<MeshCollider> meshCollider(const MeshFile& file);

/// Reads a mesh file (STL, OBJ, PLY, DAE, GLB) and makes a collider of it. Coordinates times
/// `scale` are metres; axes are taken as in the file (the up axis of DAE and GLB is ignored, with a
/// notice). A child process (meshReaderProgram()) reads the file; without that program, this
/// process does (docs/adr/0027-untrusted-files-in-children.md).
///
/// @return as meshCollider(), the path in problem and notices; also a Diagnostic when the file is
/// missing or unreadable.
[[nodiscard]] Expected<MeshCollider> loadMeshCollider(const std::string& path,
                                                      const Eigen::Vector3d& scale);
/// As above, for one of several meshes: its time is added to `time`.
/// @return also a Diagnostic when that time is over
[[nodiscard]] Expected<MeshCollider> loadMeshCollider(const std::string& path,
                                                      const Eigen::Vector3d& scale,
                                                      MeshLoadTime& time);

}  // namespace wholehand
