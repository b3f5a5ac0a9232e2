#include "loop/physics/hand_probe.hpp"

#include "loop/physics/segment_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Smallest cosine to the palm's normal in front of the palm: 75 degrees.
constexpr double kBefore = 0.26;

double boundingRadius(const SceneBody& body) {
  double radius = 0.0;
  for (const Shape& s : body.shapes) {
    radius = std::max(radius, (s.in_body.translation_m - body.com_m).norm() + outerRadius(s));
  }
  return radius;
}

/// Distance to the nearest of a body's shapes. a_m, b_m: ends of the capsule in the body's frame.
SegmentDistance nearestShape(const SceneBody& body, const Eigen::Vector3d& a_m,
                             const Eigen::Vector3d& b_m, double radius_m) noexcept {
  SegmentDistance best;
  best.distance_m = kInfinity;
  for (const Shape& shape : body.shapes) {
    const SegmentDistance one = segmentDistance(shape, a_m, b_m, radius_m, 0.0);
    if (one.distance_m < best.distance_m) best = one;
  }
  return best;
}

/// Signed distance of a target: at least 0 in front of the palm, where an overlap counts as 0, and
/// negative behind or beside it.
double signedBySide(double distance_m, bool before_palm) noexcept {
  constexpr double kLeast_m = 1e-6;  // keeps the result negative at distance 0
  return before_palm ? std::max(distance_m, 0.0) : -std::max(distance_m, kLeast_m);
}

}  // namespace

PalmDistance::PalmDistance(const HandModel& hand, const SceneModel& scene)
    : bodies_(scene.bodies.begin(),
              scene.bodies.begin() +
                  std::min<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(scene.bodies.size()),
                                           kMaxBodies)) {
  const auto hollow = std::find_if(hand.capsules.begin(), hand.capsules.end(),
                                   [](const Capsule& c) { return c.name == "hollow"; });
  const auto any = std::find_if(hand.capsules.begin(), hand.capsules.end(),
                                [&](const Capsule& c) { return c.link == hand.palm_link; });
  if (hollow != hand.capsules.end()) {
    palm_ = *hollow;
  } else if (any != hand.capsules.end()) {
    palm_ = *any;
  }
  for (const SceneBody& body : bodies_) bounding_radius_m_.push_back(boundingRadius(body));
}

PalmDistance::Result PalmDistance::operator()(const Pose& palm, const BodyState* bodies,
                                              const BodySet& targets) const noexcept {
  const Eigen::Vector3d a = palm * palm_.a_m;
  const Eigen::Vector3d b = palm * palm_.b_m;
  Result nearest{kInfinity, -1, kInfinity};
  double target_m = kInfinity;  // distance to the nearest target on any side of the palm
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Eigen::Vector3d com = bodies[i].position_m.eigen();
    const bool target = targets[i];
    const double best = target ? std::max(nearest.any_m, target_m) : nearest.any_m;
    const double reach = (b - a).norm() / 2.0 + bounding_radius_m_[i] + palm_.radius_m;
    if ((com - 0.5 * (a + b)).norm() - reach > best) continue;
    const Eigen::Matrix3d turn = bodies[i].orientation_xyzw.eigen().toRotationMatrix().transpose();
    const auto to_body_frame = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      return turn * (p - com) + bodies_[i].com_m;
    };
    const SegmentDistance is =
        nearestShape(bodies_[i], to_body_frame(a), to_body_frame(b), palm_.radius_m);
    nearest.any_m = std::min(nearest.any_m, is.distance_m);
    if (!target || !(is.distance_m < target_m)) continue;
    target_m = is.distance_m;
    // The normal points from the body to the palm. The palm's frame has z dorsal, so the normal of
    // a body in front of the palm points along +z.
    const bool before_palm = is.normal.dot(turn * palm.rotation.col(2)) > kBefore;
    nearest.target = static_cast<int>(i);
    nearest.target_m = signedBySide(target_m, before_palm);
  }
  return nearest;
}

HandProbe::HandProbe(const HandModel& hand, const SceneModel& scene)
    : palm_link_(hand.palm_link),
      axis_count_(hand.axis_count),
      palm_distance_(hand, scene),
      axis_closure_(hand, scene) {}

void HandProbe::look(const Pose* links, const WorldQuery& query, TickRecord& record) noexcept {
  const PalmDistance::Result palm =
      palm_distance_(links[palm_link_], record.bodies.data(), query.targets);
  record.palm_distance_m = palm.any_m;
  record.palm_body = palm.target;
  record.palm_target_distance_m = palm.target_m;
  axis_closure_.update(links, record.theta, record.q_s, query.closure_body, record.bodies.data(),
                       record.closure);
}

void HandProbe::clearMeasurements(TickRecord& record) const noexcept {
  record.palm_distance_m = record.palm_target_distance_m = std::numeric_limits<double>::infinity();
  record.palm_body = -1;
  record.closure = AxisPosition(axis_count_, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace wholehand
