#pragma once

#include "core/real_time.hpp"
#include "model/scene_model.hpp"

#include <Eigen/Core>

namespace wholehand {

/// How far a capsule is from a convex shape.
struct SegmentDistance {
  double distance_m = 0.0;  ///< of the surfaces at `along`; negative where they overlap
  double least_m = 0.0;     ///< no point of the capsule is nearer than this
  double along = 0.0;       ///< where on the capsule's segment, 0 at a, 1 at b
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< gradient of the distance, in a's frame
};

/// Distance of the capsule about a segment from a shape, by where the distance to the shape is
/// least on the segment. That distance is convex along it: two tangents bound it from below, and
/// the search goes on until the bound is as near as is asked for: exact to `share` of the gap, and
/// to 0.1 µm where it is 0 or nothing is left of the gap. A convex mesh that holds the segment
/// itself is as far as the radius.
/// @param a_m, b_m in the shape's body frame. Real-time safe.
[[nodiscard]] WHOLEHAND_RT SegmentDistance segmentDistance(const Shape& shape,
                                                           const Eigen::Vector3d& a_m,
                                                           const Eigen::Vector3d& b_m,
                                                           double radius_m, double share) noexcept;

/// The same where a contact's point and depth are asked for: exact to rounding, but given up as
/// soon as least_m is more than far_m. @param a_m, b_m in the shape's own frame. Real-time safe.
/// @pre the shape is no convex mesh
[[nodiscard]] WHOLEHAND_RT SegmentDistance contactDistance(const Shape& shape,
                                                           const Eigen::Vector3d& a_m,
                                                           const Eigen::Vector3d& b_m,
                                                           double radius_m, double far_m) noexcept;

}  // namespace wholehand
