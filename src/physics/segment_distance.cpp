#include "physics/segment_distance.hpp"

#include "physics/hull_distance.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr double kExact_m = 1e-7;
constexpr int kMostSteps = 24;
constexpr double kContactExact_m = 1e-13;
constexpr int kMostContactSteps = 40;

/// Distance of a point from a surface and where it grows; in the shape's own frame.
struct PointDistance {
  double distance_m;
  Vector3d normal;
};

PointDistance fromCenter(const Vector3d& p, double radius_m) {
  const double away_m = p.norm();
  const Vector3d normal = away_m > 0.0 ? Vector3d(p / away_m) : Vector3d(Vector3d::UnitX());
  return {away_m - radius_m, normal};
}

PointDistance fromBox(const Vector3d& half_m, const Vector3d& p) {
  const Vector3d over = p.cwiseAbs() - half_m;
  const Vector3d sign(std::copysign(1.0, p.x()), std::copysign(1.0, p.y()),
                      std::copysign(1.0, p.z()));
  const Vector3d out = over.cwiseMax(0.0);
  const double away_m = out.norm();
  if (away_m > 0.0) return {away_m, out.cwiseProduct(sign) / away_m};
  int face = 0;
  const double depth_m = over.maxCoeff(&face);
  return {depth_m, sign[face] * Vector3d::Unit(face)};
}

PointDistance fromCylinder(double radius_m, double height_m, const Vector3d& p) {
  const double across = std::sqrt(p.x() * p.x() + p.y() * p.y());
  const Vector3d outward =
      across > 0.0 ? Vector3d(p.x() / across, p.y() / across, 0.0) : Vector3d(Vector3d::UnitX());
  const Vector3d up(0.0, 0.0, std::copysign(1.0, p.z()));
  const double side = across - radius_m;
  const double end = std::abs(p.z()) - height_m / 2.0;
  if (side > 0.0 && end > 0.0) {
    const double away_m = std::sqrt(side * side + end * end);
    return {away_m, (side * outward + end * up) / away_m};
  }
  return side > end ? PointDistance{side, outward} : PointDistance{end, up};
}

PointDistance pointDistance(const Shape& shape, const Vector3d& p) {
  switch (shape.type) {
    case ShapeType::kBox:
      return fromBox(shape.half_extents_m, p);
    case ShapeType::kCylinder:
      return fromCylinder(shape.radius_m, shape.length_m, p);
    case ShapeType::kCapsule: {
      const double end_m = shape.length_m / 2.0;
      return fromCenter(p - Vector3d(0.0, 0.0, std::clamp(p.z(), -end_m, end_m)), shape.radius_m);
    }
    case ShapeType::kSphere:
    case ShapeType::kConvexMesh:
      break;
  }
  return fromCenter(p, shape.radius_m);
}

/// A point of the segment: where, how far, and how fast the distance grows along the segment.
struct Probe {
  double along = 0.0, distance_m = 0.0, slope_m = 0.0;
  Vector3d normal;
};

SegmentDistance found(const Probe& p, double radius_m) {
  return {p.distance_m - radius_m, p.distance_m - radius_m, p.along, p.normal, p.normal};
}

/// Between two probes. The mean of their tangents that is level along the segment bounds the
/// distance as well as both together do.
SegmentDistance found(const Probe& left, const Probe& right, double least_m, double radius_m) {
  const Probe& nearer = left.distance_m < right.distance_m ? left : right;
  const double share = right.slope_m / (right.slope_m - left.slope_m);
  return {nearer.distance_m - radius_m, least_m - radius_m, nearer.along, nearer.normal,
          share * left.normal + (1.0 - share) * right.normal};
}

/// The search, in the shape's own frame. @param enough whether a gap between the bound and the
/// least distance seen so far may stay, and that bound
template <class Enough>
SegmentDistance nearest(const Shape& shape, const Vector3d& a_m, const Vector3d& b_m,
                        double radius_m, int most_steps, const Enough& enough) {
  const Vector3d way_m = b_m - a_m;
  const auto probe = [&](double along) -> Probe {
    const PointDistance at = pointDistance(shape, a_m + along * way_m);
    return {along, at.distance_m, at.normal.dot(way_m), at.normal};
  };
  Probe left = probe(0.0);
  if (left.slope_m >= 0.0) return found(left, radius_m);
  Probe right = probe(1.0);
  if (right.slope_m <= 0.0) return found(right, radius_m);
  double least_m = 0.0;
  for (int i = 0; i < most_steps; ++i) {
    const double across = right.along - left.along;
    // Where the two tangents meet nothing lies below them; where the slope would be zero if it grew
    // evenly is the better guess on round shapes.
    const double meet = (right.distance_m - left.distance_m - right.slope_m * across) /
                        (left.slope_m - right.slope_m);
    least_m = left.distance_m + left.slope_m * meet;
    const double gap_m = std::min(left.distance_m, right.distance_m) - least_m;
    if (enough(gap_m, least_m)) break;
    const double even = across * left.slope_m / (left.slope_m - right.slope_m);
    const double step = std::clamp(i % 2 == 0 ? even : meet, 1e-3 * across, 0.999 * across);
    const Probe middle = probe(left.along + step);
    (middle.slope_m < 0.0 ? left : right) = middle;
  }
  return found(left, right, least_m, radius_m);
}

}  // namespace

SegmentDistance segmentDistance(const Shape& shape, const Vector3d& a_m, const Vector3d& b_m,
                                double radius_m, double share) noexcept {
  const Eigen::Matrix3d& turn = shape.in_body.rotation;
  const Vector3d a = turn.transpose() * (a_m - shape.in_body.translation_m);
  const Vector3d b = turn.transpose() * (b_m - shape.in_body.translation_m);
  const auto enough = [&](double gap_m, double least_m) {
    return gap_m <= kExact_m + share * std::max(least_m - radius_m, 0.0);
  };
  SegmentDistance result = shape.type == ShapeType::kConvexMesh
                               ? hullDistance(shape.points_m, a, b, radius_m)
                               : nearest(shape, a, b, radius_m, kMostSteps, enough);
  result.normal = turn * result.normal;
  result.bound_normal = turn * result.bound_normal;
  return result;
}

SegmentDistance contactDistance(const Shape& shape, const Vector3d& a_m, const Vector3d& b_m,
                                double radius_m, double far_m) noexcept {
  const auto enough = [&](double gap_m, double least_m) {
    return gap_m <= kContactExact_m || least_m - radius_m > far_m;
  };
  return nearest(shape, a_m, b_m, radius_m, kMostContactSteps, enough);
}

}  // namespace wholehand
