#pragma once

#include "loop/core/expected.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

// Checks shared by all users of a mesh. Faults name problem and remedy; the caller adds file and
// key. Not real-time safe.

/// Vertices nearer to each other than this share of the size are merged.
inline constexpr double kWeldShare = 1e-6;

/// Triangles whose vertices are merged, so that neighbours share them.
struct WeldedMesh {
  std::vector<Eigen::Vector3d> points_m;
  std::vector<Eigen::Vector3i> triangles;
  double size_m = 0.0;  ///< diagonal of the bounding box
};

/// Fault of a mesh without volume. isFlatFault() recognises it, even with the mesh's name put
/// before the problem.
[[nodiscard]] Diagnostic flatFault();
[[nodiscard]] bool isFlatFault(const Diagnostic& fault);

/// "(0.1, 0.2, 0.3) m"
[[nodiscard]] std::string place(const Eigen::Vector3d& p);

/// Diagonal of the points' bounding box [m]. @pre not empty
[[nodiscard]] double diagonal(const std::vector<Eigen::Vector3d>& points_m);

/// For each point, the index of the first point within `near_m`. This connects the triangles of
/// files that store the vertices of each triangle separately (STL).
[[nodiscard]] std::vector<int> weld(const std::vector<Eigen::Vector3d>& points, double near_m);

/// The merged vertices in use, and triangles with three different vertices. @pre no inputFault()
[[nodiscard]] WeldedMesh cleaned(const std::vector<Eigen::Vector3d>& points,
                                 const std::vector<Eigen::Vector3i>& triangles);

[[nodiscard]] Eigen::Vector3d mean(const std::vector<Eigen::Vector3d>& points);

/// Twice the triangle's area as a vector along its normal [m²].
[[nodiscard]] Eigen::Vector3d areaVector(const WeldedMesh& mesh, const Eigen::Vector3i& t);

/// Fault of a mesh that is not 0.001 to 10 m across.
[[nodiscard]] std::optional<Diagnostic> sizeFault(const WeldedMesh& mesh);

/// Fault of more than `most` triangles.
[[nodiscard]] std::optional<Diagnostic> countFault(std::size_t triangles, int most,
                                                   const char* remedy);

/// Faults that leave no surface to compute with: no faces, more than `most_triangles`, a corner
/// that is not finite, a face with a corner that does not exist.
[[nodiscard]] std::optional<Diagnostic> inputFault(const std::vector<Eigen::Vector3d>& points,
                                                   const std::vector<Eigen::Vector3i>& triangles,
                                                   int most_triangles);

}  // namespace wholehand
