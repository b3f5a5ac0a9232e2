#pragma once

#include "loop/core/real_time.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <cstddef>

namespace wholehand {

/// Distance of a capsule from a convex shape.
struct SegmentDistance {
  double distance_m = 0.0;  ///< between the surfaces at `along`; negative when they overlap
  double least_m = 0.0;     ///< lower bound of the distance
  double along = 0.0;       ///< parameter on the capsule's segment, 0 at a, 1 at b
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< gradient of the distance, in a's frame
  /// Gradient of a lower bound for points x anywhere: the distance of x from the shape, less the
  /// radius, is at least least_m + bound_normal·(x − x(along)). Not longer than 1.
  Eigen::Vector3d bound_normal = Eigen::Vector3d::Zero();
};

/// Distance of a capsule (segment and radius) from a shape, found by minimising the distance to the
/// shape along the segment. That distance is convex: two tangents bound it from below, and the
/// search continues until the bound is tight. The result is exact to `share` of the gap, and to 0.1
/// µm when the gap is 0 or negative. For a convex mesh that contains the segment itself, the
/// distance is minus the radius.
/// @param a_m, b_m in the shape's body frame. Real-time safe.
[[nodiscard]] WHOLEHAND_RT SegmentDistance segmentDistance(const Shape& shape,
                                                           const Eigen::Vector3d& a_m,
                                                           const Eigen::Vector3d& b_m,
                                                           double radius_m, double share) noexcept;

/// Like segmentDistance(), for a contact's point and depth: exact to rounding, but stops as soon as
/// least_m exceeds far_m. @param a_m, b_m in the shape's own frame. Real-time safe.
/// @pre the shape is not a convex mesh
[[nodiscard]] WHOLEHAND_RT SegmentDistance contactDistance(const Shape& shape,
                                                           const Eigen::Vector3d& a_m,
                                                           const Eigen::Vector3d& b_m,
                                                           double radius_m, double far_m) noexcept;

/// Points in a row of memory: x, y, z of each, and numbers that do not count between them.
struct PointRow {
  const double* first = nullptr;
  int count = 0;   ///< > 0
  int stride = 3;  ///< numbers from one point to the next

  [[nodiscard]] Eigen::Vector3d operator[](int i) const noexcept {
    const double* at = first + static_cast<std::ptrdiff_t>(stride) * i;
    return {at[0], at[1], at[2]};
  }
};

/// Distance of a capsule (segment and radius) from the convex hull of points, to 0.1 µm (Gilbert,
/// Johnson, Keerthi 1988, with a bound on the steps: `least_m` is valid however early it ends).
/// When the segment itself intersects the hull: minus the radius, without a normal. For the tick,
/// on fixed storage; files/scene/separation.hpp also computes the penetration depth, but only at
/// load. Real-time safe.
/// @pre all in one frame
[[nodiscard]] WHOLEHAND_RT SegmentDistance hullDistance(const PointRow& points_m,
                                                        const Eigen::Vector3d& a_m,
                                                        const Eigen::Vector3d& b_m,
                                                        double radius_m) noexcept;

}  // namespace wholehand
