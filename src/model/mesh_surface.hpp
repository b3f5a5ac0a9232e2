#pragma once

#include "core/expected.hpp"

#include <Eigen/Core>

#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// The triangles of a mesh file, as they stand in it.
struct MeshSurface {
  std::vector<Eigen::Vector3d> points;     ///< in the file's own unit
  std::vector<Eigen::Vector3i> triangles;  ///< indices of points
};

/// Reads a mesh file in this process, with a library (assimp) that a damaged file may crash.
/// @return the surface, or one Diagnostic with problem and remedy (file and key are the caller's)
[[nodiscard]] Expected<MeshSurface> readMeshHere(const std::string& path);

/// The program that reads a mesh in a process of its own: wholehand-read-mesh beside this program,
/// or in lib/wholehand of the folder above. Empty: there is none.
[[nodiscard]] std::string meshReaderProgram();

/// Runs `program FILE` with 10 s of time and 1 GB of memory, and takes the surface that it hands
/// over. What becomes of that process, this one goes on.
/// @return as readMeshHere()
[[nodiscard]] Expected<MeshSurface> readMeshInChild(const std::string& program,
                                                    const std::string& path);

/// What that program writes to its standard output: a surface, or why there is none. For two
/// processes of one machine and one build.
[[nodiscard]] std::string encodeMesh(const Expected<MeshSurface>& mesh);
/// @param text any bytes
/// @return what encodeMesh() was given. Every index is one of a point.
[[nodiscard]] Expected<MeshSurface> decodeMesh(std::string_view text);

}  // namespace wholehand
