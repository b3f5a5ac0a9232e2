#pragma once

#include "loop/core/expected.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

// Checks that every use of a mesh shares. Faults name problem and remedy; file and key are the
// caller's. Not real-time safe.

inline constexpr double kWeldShare = 1e-6;  ///< of the size: nearer vertices are merged

/// Triangles whose vertices are merged, so that neighbours share them.
struct WeldedMesh {
  std::vector<Eigen::Vector3d> points_m;
  std::vector<Eigen::Vector3i> triangles;
  double size_m = 0.0;  ///< diagonal of the bounding box
};

/// Fault of a mesh without volume, and whether a fault is that one, whatever names the mesh before
/// it.
[[nodiscard]] Diagnostic flatFault();
[[nodiscard]] bool isFlatFault(const Diagnostic& fault);

/// "(0.1, 0.2, 0.3) m"
[[nodiscard]] std::string place(const Eigen::Vector3d& p);

/// Diagonal of the points' bounding box [m]. @pre not empty
[[nodiscard]] double diagonal(const std::vector<Eigen::Vector3d>& points_m);

/// Index of the first point within `near_m` of each point. It connects files that store the
/// vertices of each triangle separately (STL).
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
