#include "loop/model/capsule_gap.hpp"

#include <algorithm>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr double kParallel = 1e-12;  ///< sin² of the angle below which segments count as parallel
constexpr double kLeast_m = 1e-12;   ///< segments nearer than this count as intersecting

double share(double way, double square) {
  return square > 0.0 ? std::clamp(way / square, 0.0, 1.0) : 0.0;
}

/// Unit vector perpendicular to both segments; to the first if they are parallel.
Vector3d across(const Vector3d& u, const Vector3d& v) {
  Vector3d n = u.cross(v);
  if (n.norm() > 0.0) return n.normalized();
  int least = 0;
  u.cwiseAbs().minCoeff(&least);
  n = u.cross(Vector3d(Vector3d::Unit(least)));
  return n.norm() > 0.0 ? Vector3d(n.normalized()) : Vector3d(Vector3d::UnitZ());
}

}  // namespace

CapsuleGap capsuleGap(const PlacedSegment& first, const PlacedSegment& second) noexcept {
  const Vector3d u = first.b_m - first.a_m;
  const Vector3d v = second.b_m - second.a_m;
  const Vector3d r = first.a_m - second.a_m;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double ur = u.dot(r), vr = v.dot(r);
  // |r + s u − t v|² is minimal where both derivatives vanish, or at an end.
  const double turned = uu * vv - uv * uv;
  double s = 0.5;
  if (turned > kParallel * uu * vv) s = std::clamp((uv * vr - ur * vv) / turned, 0.0, 1.0);
  const double t = share(uv * s + vr, vv);
  s = share(uv * t - ur, uu);
  const Vector3d apart = r + s * u - t * v;
  const double length = apart.norm();
  CapsuleGap gap;
  gap.normal = length > kLeast_m ? Vector3d(apart / length) : across(u, v);
  gap.distance_m = length - first.radius_m - second.radius_m;
  const Vector3d on_first = first.a_m + s * u - first.radius_m * gap.normal;
  const Vector3d on_second = second.a_m + t * v + second.radius_m * gap.normal;
  gap.point_m = 0.5 * (on_first + on_second);
  return gap;
}

}  // namespace wholehand
