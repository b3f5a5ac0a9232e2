#pragma once

#include "loop/dynamics/articulated_body.hpp"

#include <algorithm>
#include <limits>

namespace wholehand::test {

/// Distance between a ball and the nearest capsule of the hand; negative where they overlap [m].
inline double clearance_m(const ArticulatedBody& body, const Eigen::Vector3d& center_m,
                          double radius_m) {
  double least_m = std::numeric_limits<double>::infinity();
  for (const Capsule& c : body.hand().capsules) {
    const Pose& pose = body.linkPose(c.link);
    const Eigen::Vector3d a = pose * c.a_m, ab = pose * c.b_m - a, to = center_m - a;
    const double length_sq = ab.squaredNorm();
    const double u = length_sq > 0.0 ? std::clamp(ab.dot(to) / length_sq, 0.0, 1.0) : 0.0;
    least_m = std::min(least_m, (to - u * ab).norm() - c.radius_m - radius_m);
  }
  return least_m;
}

}  // namespace wholehand::test
