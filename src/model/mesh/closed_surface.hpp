#pragma once

#include "core/expected.hpp"
#include "model/mesh/mesh_surface.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Limit of the triangles of a surface that is divided into convex pieces.
inline constexpr int kMaxSolidTriangles = 20'000;

/// A closed surface: the boundary of a solid.
struct ClosedSurface {
  MeshSurface surface;     ///< vertices merged, triangles wound outward
  double volume_m3 = 0.0;  ///< enclosed; > 0. Space that is enclosed twice counts twice
  double size_m = 0.0;     ///< diagonal of the bounding box
  bool turned = false;     ///< the input was wound inward
};

/// Merges vertices, and verifies that the triangles enclose a volume: every edge is passed as often
/// in one direction as in the other.
///
/// @return the surface, or one Diagnostic with problem and remedy (file and key are the caller's):
/// no faces, more than kMaxSolidTriangles, not finite, not 0.001 to 10 m across, open, wound both
/// ways, flat. Not real-time safe.
[[nodiscard]] Expected<ClosedSurface> closedSurface(const std::vector<Eigen::Vector3d>& points_m,
                                                    const std::vector<Eigen::Vector3i>& triangles);

/// Volume that closed triangles enclose, by the divergence theorem [m³]; negative when they are
/// wound inward.
[[nodiscard]] double signedVolume(const MeshSurface& surface);

}  // namespace wholehand
