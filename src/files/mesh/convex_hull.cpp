#include "files/mesh/convex_hull.hpp"

#include "files/mesh/mesh_checks.hpp"
#include "loop/model/principal_axes.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <libqhull_r/libqhull_r.h>
#include <limits>
#include <string>
#include <utility>

// clang-format off
extern "C" {
}
// clang-format on
namespace wholehand {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

/// True when all points lie between two planes that are less than 1e-6 of the points' extent apart.
/// Qhull reports some such inputs as internal errors.
bool isFlat(const std::vector<Vector3d>& points) {
  Vector3d lower = points.front(), upper = lower, sum = Vector3d::Zero();
  for (const Vector3d& p : points) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
    sum += p;
  }
  const Vector3d middle = sum / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : points) spread += (p - middle) * (p - middle).transpose();
  const Vector3d thin = principalAxesOf(spread).axes.col(0);
  double below = 0.0, above = 0.0;
  for (const Vector3d& p : points) {
    below = std::min(below, thin.dot(p - points.front()));
    above = std::max(above, thin.dot(p - points.front()));
  }
  return above - below <= 1e-6 * (upper - lower).norm();
}

/// Owner of one Qhull computation and of its memory.
class Qhull {
 public:
  /// Computes the hull of `count` points. @return Qhull's exit code; 0: done
  int compute(std::size_t count, double* coordinates) {
    // Qhull prints its errors; without a file it would print them on the terminal.
    messages_ = std::fopen("/dev/null", "w");
    if (messages_ == nullptr) return qh_ERRother;
    qh_zero(&state_, messages_);
    std::array<char, 16> options{"qhull Qt Pp"};  // faces are triangles; no warnings
    return qh_new_qhull(&state_, 3, static_cast<int>(count), coordinates, False, options.data(),
                        nullptr, messages_);
  }
  Qhull() = default;
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
  ~Qhull() {
    if (messages_ == nullptr) return;
    int long_blocks = 0, long_bytes = 0;
    qh_freeqhull(&state_, !qh_ALL);
    qh_memfreeshort(&state_, &long_blocks, &long_bytes);
    std::fclose(messages_);
  }

  /// Calls `take(corners, normal)` for each face: indices of its three points, and its outward
  /// normal.
  template <class Take>
  void forEachFace(Take take) {
    const facetT* facet = state_.facet_list;
    for (; facet != nullptr && facet->next != nullptr; facet = facet->next) {
      const setelemT* vertices = facet->vertices->e;
      Vector3i corners;
      for (int k = 0; k < 3; ++k) {
        const auto* vertex = static_cast<const vertexT*>(vertices[k].p);
        corners[k] = qh_pointid(&state_, vertex->point);
      }
      take(corners, Vector3d(facet->normal[0], facet->normal[1], facet->normal[2]));
    }
  }

 private:
  qhT state_{};
  std::FILE* messages_ = nullptr;
};

/// Share of the extent; points nearer to the hull count as inside.
constexpr double kOutsideShare = 1e-5;

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

Expected<MeshSurface> convexHull(const std::vector<Vector3d>& points) {
  if (points.size() < 4 || isFlat(points)) return flatFault();
  std::vector<double> coordinates;
  coordinates.reserve(3 * points.size());
  for (const Vector3d& p : points) coordinates.insert(coordinates.end(), {p.x(), p.y(), p.z()});
  Qhull qhull;
  const int code = qhull.compute(points.size(), coordinates.data());
  if (code == qh_ERRsingular) return flatFault();
  if (code != qh_ERRnone) {
    return fileFault("",
                     "has no convex hull that can be computed (Qhull ends with code " +
                         std::to_string(code) + ")",
                     "give its convex hull");
  }
  MeshSurface hull;
  std::vector<int> index(points.size(), -1);
  qhull.forEachFace([&](Vector3i corners, const Vector3d& normal) {
    const Vector3d& p = points[corners[0]];
    const Vector3d area = (points[corners[1]] - p).cross(points[corners[2]] - p);
    if (area.dot(normal) < 0.0) std::swap(corners[1], corners[2]);
    for (int& corner : corners) {
      int& at = index[corner];
      if (at < 0) {
        at = static_cast<int>(hull.points.size());
        hull.points.push_back(points[corner]);
      }
      corner = at;
    }
    hull.triangles.push_back(corners);
  });
  return hull;
}

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
