#pragma once

#include "model/mesh/mesh_surface.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <vector>

namespace wholehand {

/// Distances to a surface of triangles, by a tree of their boxes. Not real-time safe.
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
