#include "physics/palm_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kSearchSteps = 18;  // 0.618^18: a 40 mm capsule to 7 micrometres

double boundingRadius(const SceneBody& body) {
  double radius = 0.0;
  for (const Shape& s : body.shapes) {
    double extent = s.radius_m + s.length_m / 2.0;
    if (s.type == ShapeType::kBox) extent = s.half_extents_m.norm();
    if (s.type == ShapeType::kConvexMesh) {
      extent = 0.0;
      for (const Eigen::Vector3d& p : s.points_m) extent = std::max(extent, p.norm());
    }
    radius = std::max(radius, (s.in_body.translation_m - body.com_m).norm() + extent);
  }
  return radius;
}

}  // namespace

PalmDistance::PalmDistance(const HandModel& hand, const SceneModel& scene) : bodies_(scene.bodies) {
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
                                              std::uint32_t targets) const noexcept {
  const Eigen::Vector3d a = palm * palm_.a_m;
  const Eigen::Vector3d b = palm * palm_.b_m;
  Result nearest{kInfinity, -1, kInfinity};
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Eigen::Vector3d com = bodies[i].position_m.eigen();
    const bool target = ((targets >> i) & 1U) != 0;
    const double best = target ? std::max(nearest.any_m, nearest.target_m) : nearest.any_m;
    const double reach = (b - a).norm() / 2.0 + bounding_radius_m_[i] + palm_.radius_m;
    if ((com - 0.5 * (a + b)).norm() - reach > best) continue;
    const Eigen::Matrix3d turn = bodies[i].orientation_xyzw.eigen().toRotationMatrix().transpose();
    const auto to_body_frame = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
      return turn * (p - com) + bodies_[i].com_m;
    };
    const double distance_m = toBody(bodies_[i], to_body_frame(a), to_body_frame(b));
    nearest.any_m = std::min(nearest.any_m, distance_m);
    if (target && distance_m < nearest.target_m) {
      nearest.target = static_cast<int>(i);
      nearest.target_m = distance_m;
    }
  }
  return nearest;
}

double PalmDistance::toBody(const SceneBody& body, const Eigen::Vector3d& a_m,
                            const Eigen::Vector3d& b_m) const noexcept {
  constexpr double kGolden = 0.6180339887498949;
  double best_m = kInfinity;
  for (const Shape& shape : body.shapes) {
    const auto at = [&](double u) {
      return signedDistance(shape, a_m + u * (b_m - a_m)) - palm_.radius_m;
    };
    double low = 0.0, high = 1.0;
    double u1 = 1.0 - kGolden, u2 = kGolden;
    double d1 = at(u1), d2 = at(u2);
    for (int i = 0; i < kSearchSteps; ++i) {
      if (d1 < d2) {
        high = u2, u2 = u1, d2 = d1, u1 = high - kGolden * (high - low), d1 = at(u1);
      } else {
        low = u1, u1 = u2, d1 = d2, u2 = low + kGolden * (high - low), d2 = at(u2);
      }
    }
    best_m = std::min({best_m, d1, d2, at(0.0), at(1.0)});
  }
  return best_m;
}

}  // namespace wholehand
