#pragma once

#include "core/real_time.hpp"

#include <Eigen/Core>

namespace wholehand {

/// A segment swollen by a radius, placed somewhere.
struct PlacedSegment {
  Eigen::Vector3d a_m, b_m;
  double radius_m = 0.0;
};

/// Where two capsules are nearest.
struct CapsuleGap {
  double distance_m = 0.0;  ///< between the surfaces; negative when they overlap
  Eigen::Vector3d normal;   ///< unit, from the second to the first
  Eigen::Vector3d point_m;  ///< half-way between the two surfaces
};

/// The nearest points of two segments in closed form (quadratic in the two shares, clamped to the
/// segments), less the radii. Where the segments cross the normal is square to both; where they are
/// parallel the point lies by the middle of the first. Real-time safe.
[[nodiscard]] WHOLEHAND_RT CapsuleGap capsuleGap(const PlacedSegment& first,
                                                 const PlacedSegment& second) noexcept;

}  // namespace wholehand
