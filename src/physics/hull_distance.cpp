#include "physics/hull_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr double kExact_m = 1e-7;
constexpr double kTiny_m = 1e-9;  ///< nearer than this the segment meets the hull
constexpr int kMostSteps = 24;

/// A corner of the difference segment − hull.
struct Corner {
  Vector3d at_m;
  double along;  ///< on the segment
};

/// Up to four corners with the weights of the point nearest to the origin.
struct Simplex {
  std::array<Corner, 4> corners;
  std::array<double, 4> weights{};
  int size = 0;
  Vector3d nearest_m;
};

/// Weights w with G w = r for one, two or three edges, G their dot products; false where flat.
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

/// Of the corners kept so far, only those go on that carry, together with the newest, the point
/// nearest to the origin: eight cases at most. False where none is nearer than before.
bool reduce(Simplex& simplex) {
  const int newest = simplex.size - 1;
  const Corner tip = simplex.corners[newest];
  double best_m2 = simplex.nearest_m.squaredNorm();
  Simplex best;
  for (unsigned mask = 0; mask < (1U << newest); ++mask) {
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

SegmentDistance hullDistance(const std::vector<Vector3d>& points_m, const Vector3d& a_m,
                             const Vector3d& b_m, double radius_m) noexcept {
  // The corner that lies farthest towards the origin, seen from `from`.
  const auto support = [&](const Vector3d& from) -> Corner {
    const Vector3d* farthest = &points_m.front();  // stays where all is NaN
    double most = -std::numeric_limits<double>::infinity();
    for (const Vector3d& p : points_m) {
      const double along = p.dot(from);
      if (along > most) most = along, farthest = &p;
    }
    const bool at_b = b_m.dot(from) < a_m.dot(from);
    return {(at_b ? b_m : a_m) - *farthest, at_b ? 1.0 : 0.0};
  };
  Simplex simplex;
  simplex.corners[0] = support(0.5 * (a_m + b_m) - points_m.front());
  simplex.weights[0] = 1.0;
  simplex.size = 1;
  simplex.nearest_m = simplex.corners[0].at_m;
  double away_m = simplex.nearest_m.norm(), least_m = 0.0;
  for (int i = 0; i < kMostSteps && away_m > kTiny_m; ++i) {
    const Corner corner = support(simplex.nearest_m);
    least_m = std::max(least_m, corner.at_m.dot(simplex.nearest_m) / away_m);
    if (away_m - least_m <= kExact_m) break;
    simplex.corners[simplex.size++] = corner;
    if (!reduce(simplex)) {
      --simplex.size;
      break;  // rounding: no progress left
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
