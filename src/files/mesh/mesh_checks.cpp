#include "files/mesh/mesh_checks.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace wholehand {

using Eigen::Vector3d;
using Eigen::Vector3i;

namespace {

constexpr double kMinSize_m = 1e-3, kMaxSize_m = 10.0;
constexpr const char* kFlat = "is flat or degenerate: it encloses no volume";

}  // namespace

Diagnostic flatFault() {
  return fileFault("", kFlat, "give a closed convex surface with a thickness");
}

bool isFlatFault(const Diagnostic& fault) {
  return fault.problem.ends_with(kFlat);
}

std::string place(const Vector3d& p) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g}) m", p.x(), p.y(), p.z());
}

double diagonal(const std::vector<Vector3d>& points_m) {
  Vector3d lower = points_m.front(), upper = lower;
  for (const Vector3d& p : points_m) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  return (upper - lower).norm();
}

/// For each point, the index of the first point within `near_m`. This connects the triangles of
/// files that store the vertices of each triangle separately (STL).
std::vector<int> weld(const std::vector<Vector3d>& points, double near_m) {
  // Sorts along an oblique direction. Few faces are perpendicular to it, so that few points have
  // similar coordinates along it.
  const Vector3d direction = Vector3d(0.48, 0.61, 0.77).normalized();
  std::vector<double> along_m(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) along_m[i] = direction.dot(points[i]);
  std::vector<int> sorted(points.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](int i, int j) { return along_m[i] < along_m[j]; });
  std::vector<int> same(points.size(), -1);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    int& target = same[sorted[i]];
    if (target >= 0) continue;
    target = sorted[i];
    for (std::size_t j = i + 1; j < sorted.size() && along_m[sorted[j]] - along_m[target] <= near_m;
         ++j) {
      int& other = same[sorted[j]];
      if (other < 0 && (points[sorted[j]] - points[target]).norm() <= near_m) other = target;
    }
  }
  return same;
}

/// The merged vertices in use, and triangles with three different vertices.
WeldedMesh cleaned(const std::vector<Vector3d>& points, const std::vector<Vector3i>& triangles) {
  WeldedMesh mesh;
  mesh.size_m = diagonal(points);
  const std::vector<int> same = weld(points, kWeldShare * mesh.size_m);
  std::vector<int> index(points.size(), -1);
  for (const Vector3i& t : triangles) {
    const Vector3i w(same[t[0]], same[t[1]], same[t[2]]);
    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0]) continue;
    Vector3i corners;
    for (int k = 0; k < 3; ++k) {
      int& corner = index[w[k]];
      if (corner < 0) {
        corner = static_cast<int>(mesh.points_m.size());
        mesh.points_m.push_back(points[w[k]]);
      }
      corners[k] = corner;
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

Vector3d mean(const std::vector<Vector3d>& points) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

/// Twice the triangle's area as a vector along its normal.
Vector3d areaVector(const WeldedMesh& mesh, const Vector3i& t) {
  const Vector3d& p = mesh.points_m[t[0]];
  return (mesh.points_m[t[1]] - p).cross(mesh.points_m[t[2]] - p);
}

std::optional<Diagnostic> sizeFault(const WeldedMesh& mesh) {
  if (mesh.size_m >= kMinSize_m && mesh.size_m <= kMaxSize_m) return std::nullopt;
  // Files are in metres or millimetres. A wrong scale is off by a factor of 1000.
  const double factor = mesh.size_m > kMaxSize_m ? 1e-3 : 1e3;
  return fileFault(
      "", fmt::format("is {:.4g} m across", mesh.size_m),
      fmt::format("must be 0.001 to 10 m across; with its scale times {:g} it is "
                  "{:.4g} m across{}",
                  factor, factor * mesh.size_m, factor < 1.0 ? ", as a mesh in millimetres" : ""));
}

std::optional<Diagnostic> countFault(std::size_t triangles, int most, const char* remedy) {
  if (std::cmp_less_equal(triangles, most)) return std::nullopt;
  return fileFault("", fmt::format("has {} triangles", triangles),
                   fmt::format("may have {} at most: {}", most, remedy));
}

/// Faults that leave no surface to compute with.
std::optional<Diagnostic> inputFault(const std::vector<Vector3d>& points,
                                     const std::vector<Vector3i>& triangles, int most_triangles) {
  if (points.empty() || triangles.empty()) {
    return fileFault("", "is empty: it has no faces", "give a closed convex surface");
  }
  if (auto d = countFault(triangles.size(), most_triangles, "give its convex hull, simplified")) {
    return d;
  }
  if (std::cmp_greater(points.size(),
                       3 * most_triangles)) {  // triangles have three points each at most
    return fileFault("", fmt::format("has {} corners", points.size()),
                     "remove those that belong to no face");
  }
  if (!std::all_of(points.begin(), points.end(), [](const Vector3d& p) { return p.allFinite(); })) {
    return fileFault("", "has a corner that is not finite", "give finite coordinates");
  }
  const int count = static_cast<int>(points.size());
  for (const Vector3i& t : triangles) {
    if (t.minCoeff() < 0 || t.maxCoeff() >= count) {
      return fileFault("", "has a face with a corner that does not exist", "export it again");
    }
  }
  return std::nullopt;
}

}  // namespace wholehand
