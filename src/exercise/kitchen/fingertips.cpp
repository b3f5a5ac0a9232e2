#include "exercise/kitchen/fingertips.hpp"

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"

#include <algorithm>
#include <limits>

namespace wholehand::kitchen {

using Eigen::Vector3d;

Fingertips::Fingertips(const HandModel& hand, int fingers) {
  ArticulatedBody body(hand);
  const Synergy synergy(hand);
  const auto carries = [&hand](int link) {
    return std::any_of(hand.links.begin(), hand.links.end(),
                       [link](const HandLink& other) { return other.parent == link; });
  };
  for (int i = 0; i < kPostures; ++i) {
    AxisPosition q(hand.axis_count);
    if (fingers >= 0) q[fingers] = kMost_rad * i / (kPostures - 1);
    JointPosition theta;
    synergy.expand(q, theta);
    body.updateKinematics(theta);
    for (int k = 0; k < 6; ++k) {
      const Vector3d along = (k < 3 ? 1.0 : -1.0) * Vector3d::Unit(k % 3);
      double furthest_m = -std::numeric_limits<double>::infinity();
      for (const Capsule& c : hand.capsules) {
        if (c.part == HandPart::kPalm || c.part == HandPart::kThumb || carries(c.link)) continue;
        const Vector3d tip_m = body.linkPose(c.link) * c.b_m + c.radius_m * along;
        if (along.dot(tip_m) <= furthest_m) continue;
        furthest_m = along.dot(tip_m);
        at_[i][k] = tip_m;
      }
    }
  }
}

Vector3d Fingertips::foremost(const Vector3d& toward, double flexion_rad) const noexcept {
  int k = 0;
  toward.cwiseAbs().maxCoeff(&k);
  if (toward[k] < 0.0) k += 3;
  const double place = (kPostures - 1) * std::clamp(flexion_rad / kMost_rad, 0.0, 1.0);
  const int i = std::min(static_cast<int>(place), kPostures - 2);
  return at_[i][k] + (place - i) * (at_[i + 1][k] - at_[i][k]);
}

}  // namespace wholehand::kitchen
