#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

namespace wholehand {

/// Plane: normal · p = offset. Behind it: normal · p < offset.
struct CutPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< of length 1
  double offset_m = 0.0;
  [[nodiscard]] double distance_m(const Eigen::Vector3d& p) const {
    return normal.dot(p) - offset_m;
  }
  [[nodiscard]] CutPlane turned() const { return {-normal, -offset_m}; }
};

/// A triangle of a solid's boundary.
struct Facet {
  std::array<Eigen::Vector3d, 3> corners_m;
  bool on_cut = false;  ///< part of a cut face, not of the solid's own surface
};

/// Cuts a solid: the part behind the plane. The cut face is a fan of triangles from one corner of
/// it, some of them negative where the face is not convex; volumes add up exactly, and further cuts
/// may follow. Corners within `snap_m` of the plane lie on it.
///
/// @param facets closed, wound outward
/// @return closed, wound outward; empty when nothing lies behind. Not real-time safe.
[[nodiscard]] std::vector<Facet> cutBehind(const std::vector<Facet>& facets, const CutPlane& plane,
                                           double snap_m);

/// Point where the edge meets the plane. The same bits for both directions of an edge.
/// @pre the distances `da`, `db` [m] of `a`, `b` have different signs
[[nodiscard]] Eigen::Vector3d crossing(const Eigen::Vector3d& a, double da,
                                       const Eigen::Vector3d& b, double db);

/// Volume that closed facets enclose [m³].
[[nodiscard]] double volumeOf(const std::vector<Facet>& facets);

}  // namespace wholehand
