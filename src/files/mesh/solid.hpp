#pragma once

#include "files/mesh/mesh_file.hpp"
#include "files/mesh/shells.hpp"
#include "loop/core/expected.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <vector>

namespace wholehand {

/// Maximum number of triangles of a surface that is divided into convex pieces.
inline constexpr int kMaxSolidTriangles = 20'000;

/// A closed surface: the boundary of a solid.
struct ClosedSurface {
  MeshSurface surface;     ///< vertices merged, triangles wound outward
  double volume_m3 = 0.0;  ///< enclosed; > 0. Space that is enclosed twice counts twice
  double size_m = 0.0;     ///< diagonal of the bounding box
  TurnedShells turned = TurnedShells::kNone;  ///< which shells of the input were wound inward
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

/// Cuts a solid and returns the part behind the plane. The cut face is a fan of triangles from one
/// of its corners; some have negative area when the face is not convex. Volumes add up exactly, and
/// the result can be cut again. Corners within `snap_m` of the plane lie on it.
///
/// @param facets closed, wound outward
/// @return closed, wound outward; empty when nothing lies behind. Not real-time safe.
[[nodiscard]] std::vector<Facet> cutBehind(const std::vector<Facet>& facets, const CutPlane& plane,
                                           double snap_m);

/// Point where an edge crosses the plane. Bit-identical for both directions of the edge.
/// @pre the distances `da`, `db` [m] of `a`, `b` have different signs
[[nodiscard]] Eigen::Vector3d crossing(const Eigen::Vector3d& a, double da,
                                       const Eigen::Vector3d& b, double db);

/// Volume that closed facets enclose [m³].
[[nodiscard]] double volumeOf(const std::vector<Facet>& facets);

/// Plane of a face at a reflex edge (the solid's inner angle is larger than pi): a cut along it
/// removes the edge.
struct FeaturePlane {
  CutPlane plane;
  Eigen::Vector3d edge_middle_m;
  double weight_m = 0.0;  ///< length of the edge times the sine of its angle
};

/// Both planes of every reflex edge. @pre closed, wound outward. Not real-time safe.
[[nodiscard]] std::vector<FeaturePlane> featurePlanes(const MeshSurface& surface);

/// A cut to try.
struct Candidate {
  CutPlane plane;
  /// Weight of the reflex edges on the plane, as a share of all in the cell.
  double reflex_share = 0.0;
};

/// The distinct feature planes of edges inside a cell: the 16 of the largest weight.
[[nodiscard]] std::vector<Candidate> candidatesAtEdges(const std::vector<FeaturePlane>& features,
                                                       const std::vector<CutPlane>& cell,
                                                       double size_m);

/// Computes distances to a surface of triangles with a tree of bounding boxes. Not real-time safe.
class SurfaceDistance {
 public:
  /// @param surface at least one triangle; it must outlive this object
  explicit SurfaceDistance(const MeshSurface& surface);

  /// Distance to the nearest point of the surface [m].
  [[nodiscard]] double to(const Eigen::Vector3d& p) const;

  /// How often a closed surface that is wound outward encloses the point (winding number): 0
  /// outside, 1 inside, 2 where it overlaps itself. Takes a time proportional to the triangles.
  [[nodiscard]] double windings(const Eigen::Vector3d& p) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0, count = 0;  ///< triangles of a leaf, in order_
    int left = -1, right = -1;
  };
  int build(int first, int count);
  void search(int index, const Eigen::Vector3d& p, double& nearest_m2) const;
  [[nodiscard]] double squaredDistance(int triangle, const Eigen::Vector3d& p) const;

  const MeshSurface& surface_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace wholehand
