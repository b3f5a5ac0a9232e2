#include "picture/sleeve.hpp"

#include "picture/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kClearance_m = 0.0025;  // between skin and cuff
constexpr double kCuffHalfLength_m = 0.011;
constexpr double kCuffHalfThickness_m = 0.0026;
constexpr double kSleeveLength_m = 0.30;
constexpr double kLongestWrist_m = 0.034;  // skin shown proximal of the palm's origin

/// First-order distance to an ellipse about the origin.
double ellipseDistance(const Vector2d& q, const Vector2d& half) noexcept {
  const Vector2d scaled = q.cwiseQuotient(half);
  const double rho = scaled.norm();
  if (rho < 1e-6) return -half.minCoeff();
  return rho * (rho - 1.0) / scaled.cwiseQuotient(half).norm();
}

}  // namespace

Sleeve::Sleeve(const HandModel& hand, const Pose& palm)
    : palm_(palm), to_palm_(palm.inverse()), ulnar_(hand.side == Side::kRight ? -1.0 : 1.0) {
  const double inf = std::numeric_limits<double>::infinity();
  double proximal = inf;
  for (const Capsule& c : hand.capsules) {
    if (c.link != hand.palm_link) continue;
    proximal = std::min(proximal, std::min(c.a_m.x(), c.b_m.x()) - c.radius_m);
  }
  if (proximal == inf) return;
  empty_ = false;
  rim_m_ = std::max(proximal + 0.014, -kLongestWrist_m);
  // The section of the palm's capsules at the rim: spheres along their axes, cut by the plane.
  Vector2d low(inf, inf), high(-inf, -inf);
  for (const Capsule& c : hand.capsules) {
    if (c.link != hand.palm_link) continue;
    for (int i = 0; i <= 20; ++i) {
      const Vector3d p = c.a_m + (c.b_m - c.a_m) * (i / 20.0);
      const double off = p.x() - rim_m_;
      if (std::abs(off) >= c.radius_m) continue;
      const double r = std::sqrt(c.radius_m * c.radius_m - off * off);
      low = low.cwiseMin(p.tail<2>() - Vector2d(r, r));
      high = high.cwiseMax(p.tail<2>() + Vector2d(r, r));
    }
  }
  axis_m_ = 0.5 * (low + high);
  half_m_ = 0.5 * (high - low) + Vector2d::Constant(kClearance_m);
  middle_m_ = Vector3d(rim_m_ - 0.5 * kSleeveLength_m, axis_m_.x(), axis_m_.y());
  radius_m_ = 0.5 * kSleeveLength_m + 0.07;
}

/// Palm frame about the forearm's axis, which bends gently to the little finger's side.
Vector3d Sleeve::straightened(const Vector3d& p_m) const noexcept {
  Vector3d q = to_palm_ * p_m - Vector3d(rim_m_, axis_m_.x(), axis_m_.y());
  const double behind = std::max(0.0, -0.024 - q.x());
  q.y() -= ulnar_ * 0.36 * (std::sqrt(behind * behind + 0.0016) - 0.04);
  return q;
}

double Sleeve::cuff(const Vector3d& p_m) const noexcept {
  const Vector3d q = straightened(p_m);
  const double across =
      ellipseDistance(q.tail<2>(), half_m_ + Vector2d::Constant(kCuffHalfThickness_m));
  // A rounded bar swept around the wrist.
  const double round = 0.9 * kCuffHalfThickness_m;
  const Vector2d bar(std::abs(q.x() + kCuffHalfLength_m) - (kCuffHalfLength_m - round),
                     std::abs(across) - (kCuffHalfThickness_m - round));
  return 0.9 * (bar.cwiseMax(0.0).norm() + std::min(bar.maxCoeff(), 0.0) - round);
}

double Sleeve::cloth(const Vector3d& p_m) const noexcept {
  const Vector3d q = straightened(p_m);
  const double behind = -q.x() - 2.0 * kCuffHalfLength_m;
  const double angle = std::atan2(q.z(), q.y());
  const double wrinkle = 0.0005 * std::sin(-q.x() / 0.010 + 2.0 * angle) +
                         0.0011 * std::sin(-q.x() / 0.031 + 3.0 * angle);
  const double widen = std::clamp(0.05 * behind, -0.001, 0.010) + wrinkle;
  const double across = ellipseDistance(q.tail<2>(), half_m_ + Vector2d::Constant(0.001 + widen));
  // The cloth starts inside the cuff and closes its opening there.
  const double start = q.x() + 1.2 * kCuffHalfLength_m;
  const double end = -q.x() - kSleeveLength_m;
  return 0.8 * std::max({across, start, end});
}

double Sleeve::dissolved(const Vector3d& p_m) const noexcept {
  const double behind = -straightened(p_m).x();
  return smoothStep(0.07, 0.86 * kSleeveLength_m, behind);
}

}  // namespace wholehand
