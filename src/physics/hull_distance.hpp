#pragma once

#include "core/real_time.hpp"
#include "physics/segment_distance.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Distance of the capsule about a segment from the convex hull of points, to 0.1 µm (Gilbert,
/// Johnson, Keerthi 1988, with a bound on the steps: `least_m` holds however early it ends). Where
/// the segment itself meets the hull: minus the radius, without a normal. model/separation.hpp also
/// tells how deep; this is its sibling for the tick, on fixed storage. Real-time safe.
/// @pre points_m not empty; all in one frame
[[nodiscard]] WHOLEHAND_RT SegmentDistance
hullDistance(const std::vector<Eigen::Vector3d>& points_m, const Eigen::Vector3d& a_m,
             const Eigen::Vector3d& b_m, double radius_m) noexcept;

}  // namespace wholehand
