#include "model/mesh/convex_mesh.hpp"

#include "model/mesh/convex_hull.hpp"
#include "model/mesh/mesh_checks.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kConvexShare = 1e-4;  ///< of the size: smaller dents are rounding

/// True for a triangle so thin that its normal is rounding noise; it counts for closedness only.
bool isSliver(const WeldedMesh& mesh, const Vector3i& t) {
  double longest_m = 0.0;
  for (int k = 0; k < 3; ++k) {
    longest_m = std::max(longest_m, (mesh.points_m[t[(k + 1) % 3]] - mesh.points_m[t[k]]).norm());
  }
  return areaVector(mesh, t).norm() <= kWeldShare * mesh.size_m * longest_m;
}

/// Turns every triangle's winding so that its normal points away from `inside`.
void windOutward(WeldedMesh& mesh, const Vector3d& inside) {
  for (Vector3i& t : mesh.triangles) {
    if (areaVector(mesh, t).dot(mesh.points_m[t[0]] - inside) < 0.0) std::swap(t[1], t[2]);
  }
}

std::optional<Diagnostic> dentFault(const WeldedMesh& mesh) {
  double worst_m = kConvexShare * mesh.size_m;
  std::optional<Diagnostic> found;
  for (const Vector3i& t : mesh.triangles) {
    if (isSliver(mesh, t)) continue;
    const Vector3d normal = areaVector(mesh, t).normalized();
    for (const Vector3d& p : mesh.points_m) {
      const double outside_m = normal.dot(p - mesh.points_m[t[0]]);
      if (outside_m <= worst_m) continue;
      worst_m = outside_m;
      found =
          meshFault(fmt::format("is not convex: its corner {} lies {:.3g} mm outside the plane of "
                                "the face at {}",
                                place(p), 1e3 * outside_m, place(mesh.points_m[t[0]])),
                    "give its convex hull, or convex pieces (wholehand decompose makes them)");
    }
  }
  return found;
}

std::optional<Diagnostic> holeFault(const WeldedMesh& mesh) {
  std::map<std::pair<int, int>, int> faces_at_edge;
  for (const Vector3i& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = std::minmax(t[k], t[(k + 1) % 3]);
      ++faces_at_edge[{i, j}];
    }
  }
  for (const auto& [edge, count] : faces_at_edge) {
    if (count == 2) continue;
    return meshFault(
        fmt::format("is not watertight: the edge from {} to {} belongs to {} face{}, not 2",
                    place(mesh.points_m[edge.first]), place(mesh.points_m[edge.second]), count,
                    count == 1 ? "" : "s"),
        "close its holes, or give its convex hull");
  }
  return std::nullopt;
}

/// Volume that a surface encloses [m³], by the divergence theorem. Empty when it is not closed or
/// not wound one way: some edge is then not passed as often in one direction as in the other.
std::optional<double> enclosedVolume(const std::vector<Vector3d>& points_m,
                                     const std::vector<Vector3i>& triangles) {
  const auto before = [&](int i, int j) {
    return std::lexicographical_compare(points_m[i].begin(), points_m[i].end(), points_m[j].begin(),
                                        points_m[j].end());
  };
  // The same number for corners at the same place: STL stores them for each triangle.
  std::vector<int> sorted(points_m.size()), same(points_m.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::sort(sorted.begin(), sorted.end(), before);
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const bool repeated = k > 0 && !before(sorted[k - 1], sorted[k]);
    same[sorted[k]] = repeated ? same[sorted[k - 1]] : sorted[k];
  }
  std::map<std::pair<int, int>, int> passes;  // upwards less downwards
  const Vector3d inside = mean(points_m);
  double volume_m3 = 0.0;
  for (const Vector3i& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const int i = same[t[k]], j = same[t[(k + 1) % 3]];
      passes[std::minmax(i, j)] += i < j ? 1 : (i > j ? -1 : 0);
    }
    const Vector3d p = points_m[t[0]] - inside, q = points_m[t[1]] - inside;
    volume_m3 += p.dot(q.cross(points_m[t[2]] - inside)) / 6.0;
  }
  const bool closed =
      std::all_of(passes.begin(), passes.end(), [](const auto& edge) { return edge.second == 0; });
  return closed ? std::optional<double>(std::abs(volume_m3)) : std::nullopt;
}

/// Convex hull of a mesh, its corners further apart than convexMesh() merges.
Expected<MeshSurface> hullOf(const std::vector<Vector3d>& points_m,
                             const std::vector<Vector3i>& triangles) {
  std::vector<bool> used(points_m.size());
  for (const Vector3i& t : triangles) used[t[0]] = used[t[1]] = used[t[2]] = true;
  std::vector<Vector3d> corners_m;
  for (std::size_t i = 0; i < points_m.size(); ++i) {
    if (used[i]) corners_m.push_back(points_m[i]);
  }
  Expected<MeshSurface> hull = convexHull(corners_m);
  if (!hull) return hull;
  if (auto d = countFault(hull->triangles.size(), 2 * kMaxMeshPoints, "simplify the mesh")) {
    d->problem = "needs a convex hull that " + d->problem;
    return *d;
  }
  const std::vector<int> same = weld(hull->points, kWeldShare * diagonal(hull->points));
  std::vector<Vector3d> apart_m;
  for (std::size_t i = 0; i < same.size(); ++i) {
    if (same[i] == static_cast<int>(i)) apart_m.push_back(hull->points[i]);
  }
  return apart_m.size() == hull->points.size() ? std::move(hull) : convexHull(apart_m);
}

/// Message for the user when a hull takes the place of a mesh. @param why the mesh is no collider
Diagnostic hullNotice(std::string why, double hull_m3, std::optional<double> mesh_m3) {
  why += "; its convex hull takes its place, ";
  // A surface that overlaps itself counts some space twice.
  if (mesh_m3 && *mesh_m3 > 0.0 && *mesh_m3 <= hull_m3 * (1.0 + kConvexShare)) {
    why +=
        fmt::format("{:.3g} % larger in volume", 100.0 * std::max(hull_m3 / *mesh_m3 - 1.0, 0.0));
  } else {
    why += fmt::format(
        "of {:.3g} cm3 (how much the mesh itself encloses is unknown: it is not "
        "closed, not wound one way, or overlaps itself)",
        1e6 * hull_m3);
  }
  return meshFault(std::move(why),
                   "the hand cannot reach into a hollow of it; where it shall, give convex pieces "
                   "(wholehand decompose makes them)");
}

}  // namespace

Expected<Shape> convexMesh(const std::vector<Vector3d>& points_m,
                           const std::vector<Vector3i>& triangles) {
  if (auto d = inputFault(points_m, triangles, 2 * kMaxMeshPoints)) return *d;
  WeldedMesh mesh = cleaned(points_m, triangles);
  if (auto d = sizeFault(mesh)) return *d;
  const Diagnostic flat = meshFault("is flat or degenerate: it encloses no volume",
                                    "give a closed convex surface with a thickness");
  if (mesh.triangles.empty()) return flat;
  windOutward(mesh, mean(mesh.points_m));
  if (auto d = dentFault(mesh)) return *d;

  Shape shape;
  shape.type = ShapeType::kConvexMesh;
  shape.points_m = mesh.points_m;
  std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(shape.triangles),
               [&](const Vector3i& t) { return !isSliver(mesh, t); });
  const double cube_m3 = mesh.size_m * mesh.size_m * mesh.size_m;
  if (moments(shape).volume_m3 < kWeldShare * cube_m3) return flat;
  if (auto d = holeFault(mesh)) return *d;
  return shape;
}

Expected<MeshCollider> meshCollider(const std::vector<Vector3d>& points_m,
                                    const std::vector<Vector3i>& triangles) {
  if (auto d = inputFault(points_m, triangles, kMaxMeshTriangles)) return *d;
  Expected<Shape> itself = convexMesh(points_m, triangles);
  if (itself) return MeshCollider{std::move(*itself), std::nullopt};
  const Expected<MeshSurface> hull = hullOf(points_m, triangles);
  if (!hull) return hull.errors();
  Expected<Shape> shape = convexMesh(hull->points, hull->triangles);
  if (!shape) return shape.errors();
  Diagnostic notice = hullNotice(itself.errors().front().problem, moments(*shape).volume_m3,
                                 enclosedVolume(points_m, triangles));
  return MeshCollider{std::move(*shape), std::move(notice)};
}

}  // namespace wholehand
