#include "rig/registry/hand_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

double distanceToSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                         const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - share * along).norm();
}

}  // namespace

HandReach::HandReach(const HandModel& hand, const DeviceModel& device, double within_s)
    : hand_(hand), device_(device), within_s_(within_s), body_(hand) {
  capsules_.resize(hand.capsules.size());
}

double HandReach::travelOf(int link, const Eigen::Vector3d& point_m,
                           const AxisPosition& change) const {
  std::array<std::array<double, kMaxAxes>, 3> rows{};
  for (int k = 0; k < 3; ++k) {
    body_.reducedPointRow(link, point_m, Eigen::Vector3d::Unit(k), rows[k].data());
  }
  double slid_m2 = 0.0, turned_m = 0.0;
  for (int a = 0; a < change.size(); ++a) {
    const double moved_m = change[a] * std::hypot(rows[0][a], rows[1][a], rows[2][a]);
    if (device_.axes[a].kind == AxisKind::kTranslation) {
      slid_m2 += moved_m * moved_m;
    } else {
      turned_m += moved_m;
    }
  }
  return std::sqrt(slid_m2) + turned_m;
}

void HandReach::look(const AxisPosition& q_s, const JointPosition& theta) {
  body_.updateKinematics(theta);
  AxisPosition change(q_s.size());
  for (int a = 0; a < q_s.size(); ++a) {
    const DeviceAxis& axis = device_.axes[a];
    const double room = std::max({axis.upper - q_s[a], q_s[a] - axis.lower, 0.0});
    change[a] = std::min(axis.speed_limit * within_s_, room);
  }
  middle_m_.setZero();
  for (std::size_t i = 0; i < capsules_.size(); ++i) {
    const Capsule& capsule = hand_.capsules[i];
    const Pose& at = body_.linkPose(capsule.link);
    Finger& out = capsules_[i];
    out.a_m = at * capsule.a_m;
    out.b_m = at * capsule.b_m;
    out.radius_m = capsule.radius_m;
    out.travel_m =
        std::max(travelOf(capsule.link, out.a_m, change), travelOf(capsule.link, out.b_m, change));
    middle_m_ += 0.5 * (out.a_m + out.b_m) / static_cast<double>(capsules_.size());
  }
  farthest_m_ = extent_m_ = 0.0;
  for (const Finger& c : capsules_) {
    const double far_m =
        std::max((c.a_m - middle_m_).norm(), (c.b_m - middle_m_).norm()) + c.radius_m;
    extent_m_ = std::max(extent_m_, far_m);
    farthest_m_ = std::max(farthest_m_, far_m + c.travel_m);
  }
}

HandReach::Distance HandReach::to(const Eigen::Vector3d& centre_m, double radius_m,
                                  double far_m) const {
  const double away_m = (centre_m - middle_m_).norm() - radius_m;
  if (away_m - farthest_m_ > far_m) return {away_m - extent_m_, away_m - farthest_m_};
  Distance out{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (const Finger& c : capsules_) {
    const double now_m = distanceToSegment(centre_m, c.a_m, c.b_m) - c.radius_m - radius_m;
    out.now_m = std::min(out.now_m, now_m);
    out.missed_m = std::min(out.missed_m, now_m - c.travel_m);
  }
  return out;
}

}  // namespace wholehand
