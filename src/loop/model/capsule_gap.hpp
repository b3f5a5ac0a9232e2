#pragma once

#include "loop/core/real_time.hpp"

#include <Eigen/Core>

namespace wholehand {

/// A segment with a radius, in a common frame.
struct PlacedSegment {
  Eigen::Vector3d a_m, b_m;
  double radius_m = 0.0;
};

/// Nearest points of two capsules.
struct CapsuleGap {
  double distance_m = 0.0;  ///< between the surfaces; negative when they overlap
  Eigen::Vector3d normal;   ///< unit, from the second to the first
  Eigen::Vector3d point_m;  ///< half-way between the two surfaces
};

/// Nearest points of two segments in closed form (quadratic in the two parameters, clamped to the
/// segments), minus the radii. If the segments intersect, the normal is perpendicular to both; if
/// they are parallel, the point lies at the middle of the first. Real-time safe.
[[nodiscard]] WHOLEHAND_RT CapsuleGap capsuleGap(const PlacedSegment& first,
                                                 const PlacedSegment& second) noexcept;

}  // namespace wholehand
