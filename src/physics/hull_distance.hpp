#pragma once

#include "core/real_time.hpp"
#include "physics/segment_distance.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Distance of a capsule (segment and radius) from the convex hull of points, to 0.1 µm (Gilbert,
/// Johnson, Keerthi 1988, with a bound on the steps: `least_m` is valid however early it ends).
/// When the segment itself intersects the hull: minus the radius, without a normal. For the tick,
/// on fixed storage; model/scene/separation.hpp also computes the penetration depth, but only at
/// load. Real-time safe.
/// @pre points_m not empty; all in one frame
[[nodiscard]] WHOLEHAND_RT SegmentDistance
hullDistance(const std::vector<Eigen::Vector3d>& points_m, const Eigen::Vector3d& a_m,
             const Eigen::Vector3d& b_m, double radius_m) noexcept;

}  // namespace wholehand
