#include "loop/physics/segment_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace wholehand {

namespace {

using Eigen::Vector3d;

constexpr double kExact_m = 1e-7;  // accuracy of segmentDistance() and hullDistance()
constexpr int kMostSteps = 24;
constexpr double kContactExact_m = 1e-13;  // accuracy of contactDistance()
constexpr int kMostContactSteps = 40;

/// A point of the segment: its parameter, its distance from the shape, and the slope of the
/// distance along the segment.
struct Probe {
  double along = 0.0, distance_m = 0.0, slope_m = 0.0;
  Vector3d normal;
};

SegmentDistance found(const Probe& p, double radius_m) {
  return {p.distance_m - radius_m, p.distance_m - radius_m, p.along, p.normal, p.normal};
}

/// Result of a minimum between two probes. The weighted mean of their tangents that is level along
/// the segment bounds the distance as well as both tangents together.
SegmentDistance found(const Probe& left, const Probe& right, double least_m, double radius_m) {
  const Probe& nearer = left.distance_m < right.distance_m ? left : right;
  const double share = right.slope_m / (right.slope_m - left.slope_m);
  return {nearer.distance_m - radius_m, least_m - radius_m, nearer.along, nearer.normal,
          share * left.normal + (1.0 - share) * right.normal};
}

/// Searches the nearest point, in the shape's own frame. @param enough returns true when the search
/// may stop, given the gap between the bound and the least distance seen so far, and the bound
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
    // `meet` is where the two tangents intersect: no distance lies below that point. `even` is
    // where the slope would be zero if it grew linearly, a better guess on round shapes.
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
  const auto points = [&] {
    return PointRow{shape.points_m.front().data(), static_cast<int>(shape.points_m.size())};
  };
  SegmentDistance result = shape.isMesh() ? hullDistance(points(), a, b, radius_m)
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

namespace {

constexpr double kTiny_m = 1e-9;  ///< nearer than this the segment meets the hull
constexpr int kMostHullSteps = 24;

/// A corner of the difference segment − hull.
struct Corner {
  Vector3d at_m;
  double along;  ///< parameter on the segment, 0 .. 1
};

/// Up to four corners with the weights of the point nearest to the origin.
struct Simplex {
  std::array<Corner, 4> corners;
  std::array<double, 4> weights{};
  int size = 0;
  Vector3d nearest_m;
};

/// Solves G w = r for the weights w of one, two or three edges, with G their dot products; false
/// when the edges are degenerate.
bool solve(int n, const std::array<Vector3d, 3>& edges, const Vector3d& base,
           std::array<double, 3>& w) {
  if (n == 1) {
    const double g = edges[0].squaredNorm();
    w[0] = -edges[0].dot(base) / g;
    return g > 0.0;
  }
  if (n == 2) {
    const double a = edges[0].squaredNorm(), b = edges[0].dot(edges[1]), c = edges[1].squaredNorm();
    const double r0 = -edges[0].dot(base), r1 = -edges[1].dot(base);
    const double area2 = a * c - b * b;
    w = {(c * r0 - b * r1) / area2, (a * r1 - b * r0) / area2, 0.0};
    return area2 > 1e-14 * a * c;
  }
  const Vector3d across = edges[1].cross(edges[2]);
  const double volume = edges[0].dot(across);
  w = {-base.dot(across) / volume, -edges[0].dot(base.cross(edges[2])) / volume,
       -edges[0].dot(edges[1].cross(base)) / volume};
  return std::abs(volume) > 1e-14 * edges[0].norm() * across.norm();
}

/// Reduces the simplex to the corners that carry, together with the newest one, the point nearest
/// to the origin (at most eight cases). Returns false when no point is nearer than before.
bool reduce(Simplex& simplex) {
  const int newest = simplex.size - 1;
  const Corner tip = simplex.corners[newest];
  double best_m2 = simplex.nearest_m.squaredNorm();
  Simplex best;
  for (unsigned mask = 0; mask < (1U << newest); ++mask) {
    // The corners of this case, and the nearest point of the plane, line or space through them.
    Simplex part;
    std::array<Vector3d, 3> edges;
    std::array<double, 3> w{};
    for (int i = 0; i < newest; ++i) {
      if (((mask >> i) & 1U) == 0) continue;
      const Corner& corner = simplex.corners[i];
      edges[part.size] = corner.at_m - tip.at_m;
      part.corners[part.size++] = corner;
    }
    if (part.size > 0 && !solve(part.size, edges, tip.at_m, w)) continue;
    double rest = 1.0;
    part.nearest_m = tip.at_m;
    bool inside = true;
    for (int i = 0; i < part.size; ++i) {
      inside = inside && w[i] >= 0.0;
      rest -= w[i];
      part.nearest_m += w[i] * edges[i];
      part.weights[i] = w[i];
    }
    // Keeps the case with the nearest point inside the part.
    if (!inside || rest < 0.0) continue;
    const double m2 = part.size == 3 ? 0.0 : part.nearest_m.squaredNorm();
    if (!(m2 < best_m2)) continue;
    best_m2 = m2;
    part.corners[part.size] = tip;
    part.weights[part.size++] = rest;
    best = part;
  }
  if (best.size == 0) return false;
  simplex = best;
  return true;
}

}  // namespace

SegmentDistance hullDistance(const PointRow& points_m, const Vector3d& a_m, const Vector3d& b_m,
                             double radius_m) noexcept {
  // The corner of the difference that is farthest towards the origin, seen from `from`.
  const auto support = [&](const Vector3d& from) -> Corner {
    int farthest = 0;  // stays when all numbers are NaN
    double most = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < points_m.count; ++i) {
      const double along = points_m[i].dot(from);
      if (along > most) most = along, farthest = i;
    }
    const bool at_b = b_m.dot(from) < a_m.dot(from);
    return {(at_b ? b_m : a_m) - points_m[farthest], at_b ? 1.0 : 0.0};
  };
  Simplex simplex;
  simplex.corners[0] = support(0.5 * (a_m + b_m) - points_m[0]);
  simplex.weights[0] = 1.0;
  simplex.size = 1;
  simplex.nearest_m = simplex.corners[0].at_m;
  double away_m = simplex.nearest_m.norm(), least_m = 0.0;
  for (int i = 0; i < kMostHullSteps && away_m > kTiny_m; ++i) {
    const Corner corner = support(simplex.nearest_m);
    least_m = std::max(least_m, corner.at_m.dot(simplex.nearest_m) / away_m);
    if (away_m - least_m <= kExact_m) break;
    simplex.corners[simplex.size++] = corner;
    if (!reduce(simplex)) {
      --simplex.size;
      break;  // no further progress: rounding
    }
    away_m = simplex.size == 4 ? 0.0 : simplex.nearest_m.norm();
  }
  if (away_m <= kTiny_m) return {-radius_m, -radius_m, 0.5, Vector3d::Zero(), Vector3d::Zero()};
  double along = 0.0;
  for (int i = 0; i < simplex.size; ++i) {
    along += simplex.weights[i] * simplex.corners[i].along;
  }
  const Vector3d normal = simplex.nearest_m / away_m;
  return {away_m - radius_m, least_m - radius_m, along, normal, normal};
}

}  // namespace wholehand
