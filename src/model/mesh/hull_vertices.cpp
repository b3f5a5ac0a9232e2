#include "model/mesh/hull_vertices.hpp"

#include "model/mesh/convex_hull.hpp"
#include "model/mesh/mesh_checks.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kOutsideShare = 1e-5;  ///< of the extent

/// The point for which `measure` is largest; the first of equal ones.
template <class Measure>
Vector3d extreme(const std::vector<Vector3d>& points, Measure measure) {
  return *std::max_element(points.begin(), points.end(), [&](const Vector3d& a, const Vector3d& b) {
    return measure(a) < measure(b);
  });
}

std::vector<Vector3d> fourExtremePoints(const std::vector<Vector3d>& points) {
  const Vector3d a = extreme(points, [](const Vector3d& p) { return p.x(); });
  const Vector3d b = extreme(points, [&](const Vector3d& p) { return (p - a).norm(); });
  const Vector3d along = (b - a).normalized();
  const Vector3d c = extreme(points, [&](const Vector3d& p) { return along.cross(p - a).norm(); });
  const Vector3d across = along.cross(c - a);
  const Vector3d d =
      extreme(points, [&](const Vector3d& p) { return std::abs(across.dot(p - a)); });
  return {a, b, c, d};
}

/// Largest distance of the point from the planes of the hull's faces.
double outside(const MeshSurface& hull, const std::vector<Vector3d>& normals, const Vector3d& p) {
  double largest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < normals.size(); ++i) {
    largest = std::max(largest, normals[i].dot(p - hull.points[hull.triangles[i][0]]));
  }
  return largest;
}

}  // namespace

Expected<MeshSurface> reducedHull(const std::vector<Vector3d>& points_m, int most_vertices) {
  std::vector<Vector3d> points;
  for (const Vector3d& p : points_m) points.emplace_back(p.cast<float>().cast<double>());
  const double size_m = diagonal(points);
  if (auto whole = convexHull(points)) points = whole->points;
  std::vector<Vector3d> taken = fourExtremePoints(points);
  auto hull = convexHull(taken);
  while (hull && static_cast<int>(taken.size()) < most_vertices) {
    std::vector<Vector3d> normals;
    for (const Vector3i& t : hull->triangles) {
      const Vector3d& a = hull->points[t[0]];
      normals.push_back((hull->points[t[1]] - a).cross(hull->points[t[2]] - a).normalized());
    }
    double farthest = kOutsideShare * size_m;
    const Vector3d* next = nullptr;
    for (const Vector3d& p : points) {
      const double distance = outside(*hull, normals, p);
      if (distance <= farthest) continue;
      farthest = distance;
      next = &p;
    }
    if (next == nullptr) break;
    taken.push_back(*next);
    hull = convexHull(taken);
  }
  return hull;
}

}  // namespace wholehand
