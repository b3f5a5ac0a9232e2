#include "files/mesh/convex_mesh.hpp"

#include "files/mesh/convex_hull.hpp"
#include "files/mesh/mesh_checks.hpp"
#include "files/mesh/shells.hpp"
#include "loop/core/printable.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kConvexShare = 1e-4;  ///< share of the size; smaller dents count as rounding

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

/// Drops repeated triangles: a two-sided surface contains each triangle twice.
void dropRepeated(WeldedMesh& mesh) {
  std::set<std::array<int, 3>> known;
  std::erase_if(mesh.triangles, [&](const Vector3i& t) {
    std::array<int, 3> corners = {t[0], t[1], t[2]};
    std::sort(corners.begin(), corners.end());
    return !known.insert(corners).second;
  });
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
          fileFault("",
                    fmt::format("is not convex: its corner {} lies {:.3g} mm outside the plane of "
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
    return fileFault(
        "",
        fmt::format("is not watertight: the edge from {} to {} belongs to {} face{}, not 2",
                    place(mesh.points_m[edge.first]), place(mesh.points_m[edge.second]), count,
                    count == 1 ? "" : "s"),
        "close its holes, or give its convex hull");
  }
  return std::nullopt;
}

std::vector<int> welded(const MeshSurface& mesh) {
  return weld(mesh.points, kWeldShare * diagonal(mesh.points));
}

/// Volume that a surface encloses [m³], by the divergence theorem; negative when the surface is
/// wound inward. Empty when the surface is not closed or not wound consistently: then some edge is
/// not passed equally often in both directions.
std::optional<double> enclosedVolume(const MeshSurface& mesh) {
  const std::vector<int> same = welded(mesh);
  std::map<std::pair<int, int>, int>
      passes;  // passes from lower to higher index, minus passes back
  const Vector3d inside = mean(mesh.points);
  double volume_m3 = 0.0;
  for (const Vector3i& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int i = same[t[k]], j = same[t[(k + 1) % 3]];
      passes[std::minmax(i, j)] += i < j ? 1 : (i > j ? -1 : 0);
    }
    const Vector3d p = mesh.points[t[0]] - inside, q = mesh.points[t[1]] - inside;
    volume_m3 += p.dot(q.cross(mesh.points[t[2]] - inside)) / 6.0;
  }
  const bool closed =
      std::all_of(passes.begin(), passes.end(), [](const auto& edge) { return edge.second == 0; });
  return closed ? std::optional<double>(volume_m3) : std::nullopt;
}

/// Selects the points that lie farthest along kMaxMeshPoints directions spread evenly over the
/// sphere.
std::vector<Vector3d> farthestCorners(const std::vector<Vector3d>& points_m) {
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::set<std::size_t> taken;
  for (int i = 0; i < kMaxMeshPoints; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kMaxMeshPoints, r = std::sqrt(1.0 - z * z);
    const Vector3d direction(r * std::cos(golden * i), r * std::sin(golden * i), z);
    std::size_t farthest = 0;
    double most_m = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < points_m.size(); ++k) {
      const double along_m = direction.dot(points_m[k]);
      if (along_m <= most_m) continue;
      most_m = along_m;
      farthest = k;
    }
    taken.insert(farthest);
  }
  std::vector<Vector3d> corners_m;
  for (const std::size_t k : taken) corners_m.push_back(points_m[k]);
  return corners_m;
}

/// Largest distance of the points from the planes of a hull's faces [m]; >= 0.
double farthestOutside(const MeshSurface& hull, const std::vector<Vector3d>& points_m) {
  double most_m = 0.0;
  for (const Vector3i& t : hull.triangles) {
    const Vector3d& a = hull.points[t[0]];
    const Vector3d normal = (hull.points[t[1]] - a).cross(hull.points[t[2]] - a).normalized();
    for (const Vector3d& p : points_m) most_m = std::max(most_m, normal.dot(p - a));
  }
  return most_m;
}

/// A convex hull that stands for a mesh.
struct StandIn {
  Shape shape;
  double hull_m3 = 0.0;                 ///< volume of the unreduced hull
  std::optional<double> outside_m;      ///< distance of the dropped corners from the reduced hull;
                                        ///< empty: no corner was dropped
  std::optional<double> enclosed_m3{};  ///< volume that the mesh encloses; empty: unknown
};

/// Convex hull of a mesh. Its corners are farther apart than the distance at which convexMesh()
/// merges.
Expected<StandIn> standIn(const MeshSurface& mesh) {
  std::vector<bool> used(mesh.points.size());
  for (const Vector3i& t : mesh.triangles) used[t[0]] = used[t[1]] = used[t[2]] = true;
  std::vector<Vector3d> corners_m;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (used[i]) corners_m.push_back(mesh.points[i]);
  }
  Expected<MeshSurface> hull = convexHull(corners_m);
  if (!hull) return hull.errors();
  StandIn found;
  found.hull_m3 = moments(shapeOf(*hull)).volume_m3;
  const std::vector<Vector3d> all_m = hull->points;
  if (hull->triangles.size() > std::size_t{2 * kMaxMeshPoints}) {
    hull = convexHull(farthestCorners(all_m));
    if (!hull) return hull.errors();
    found.outside_m = farthestOutside(*hull, all_m);
  }
  const std::vector<int> same = weld(hull->points, kWeldShare * diagonal(hull->points));
  std::vector<Vector3d> apart_m;
  for (std::size_t i = 0; i < same.size(); ++i) {
    if (same[i] == static_cast<int>(i)) apart_m.push_back(hull->points[i]);
  }
  if (apart_m.size() < hull->points.size()) hull = convexHull(apart_m);
  if (!hull) return hull.errors();
  Expected<Shape> shape = convexMesh(hull->points, hull->triangles);
  if (!shape) return shape.errors();
  found.shape = std::move(*shape);
  std::optional<double> enclosed_m3 = enclosedVolume(mesh);
  if (enclosed_m3) enclosed_m3 = std::abs(*enclosed_m3);
  // A surface that overlaps itself counts some space twice. In a two-sided surface the two sides
  // cancel. Both give a volume outside these bounds.
  if (enclosed_m3 && *enclosed_m3 > kConvexShare * found.hull_m3 &&
      *enclosed_m3 <= found.hull_m3 * (1.0 + kConvexShare)) {
    found.enclosed_m3 = enclosed_m3;
  }
  return found;
}

/// "20 % larger"
std::string volumeChange(double is_m3, double was_m3) {
  const double percent = 100.0 * (is_m3 / was_m3 - 1.0);
  return fmt::format("{:.3g} % {} in volume", std::abs(percent) < 1e-4 ? 0.0 : std::abs(percent),
                     percent < -1e-4 ? "smaller" : "larger");
}

/// Message for the user when a hull replaces a mesh. @param why reason why the mesh is not a
/// collider
Diagnostic hullNotice(std::string why, const StandIn& hull) {
  const double is_m3 = moments(hull.shape).volume_m3;
  why += "; its convex hull takes its place, ";
  if (hull.outside_m) {
    why += fmt::format("with {} corners, which the others are {:.2g} mm outside of at most, ",
                       hull.shape.points_m.size(), 1e3 * *hull.outside_m);
  }
  if (hull.enclosed_m3) {
    why += volumeChange(is_m3, *hull.enclosed_m3);
  } else {
    why += fmt::format(
        "of {:.3g} cm3 (how much the mesh itself encloses is unknown: it is not "
        "closed, not wound one way, or overlaps itself)",
        1e6 * is_m3);
  }
  return fileFault("", std::move(why),
                   "the hand cannot reach into a hollow of it; where it shall, give convex pieces "
                   "(wholehand decompose makes them)");
}

constexpr int kMostParts = 256;  ///< maximum number of parts of one mesh
/// Ratio of hull volume to part volume; a part above it is not convex.
constexpr double kNearlyConvex = 1.05;

/// The triangles of each part as a surface with its own corners. Empty: more than kMostParts.
std::vector<MeshSurface> divided(const MeshSurface& mesh, const std::vector<int>& part) {
  std::map<int, MeshSurface> parts;
  std::map<std::pair<int, int>, int>
      index;  // (part, corner of the mesh) to corner of the part's surface
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    MeshSurface& own = parts[part[i]];
    if (parts.size() > std::size_t{kMostParts}) return {};
    Vector3i t = mesh.triangles[i];
    for (int& corner : t) {
      const auto [at, is_new] =
          index.try_emplace({part[i], corner}, static_cast<int>(own.points.size()));
      if (is_new) own.points.push_back(mesh.points[corner]);
      corner = at->second;
    }
    own.triangles.push_back(t);
  }
  std::vector<MeshSurface> all;
  for (auto& [number, own] : parts) all.push_back(std::move(own));
  return all;
}

/// A convex part.
struct ConvexPart {
  Shape shape;
  double enclosed_m3 = 0.0;  ///< volume of the part itself; for a convex part the volume of `shape`
  bool inward = false;       ///< wound inwards
};

/// True when every corner of `inner` lies inside `outer`.
bool liesIn(const Shape& inner, const Shape& outer) {
  const double near_m = kWeldShare * diagonal(outer.points_m);
  return std::all_of(inner.points_m.begin(), inner.points_m.end(),
                     [&](const Vector3d& p) { return signedDistance(outer, p) <= near_m; });
}

/// Removes parts that lie inside another part and cannot be touched. Returns false when such a part
/// is wound the opposite way, because it is then a hollow.
bool dropInner(std::vector<ConvexPart>& parts) {
  for (std::size_t outer = 0; outer < parts.size(); ++outer) {
    for (std::size_t inner = parts.size(); inner-- > 0;) {
      if (inner == outer || !liesIn(parts[inner].shape, parts[outer].shape)) continue;
      if (parts[inner].inward != parts[outer].inward) return false;
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(inner));
      if (inner < outer) --outer;
    }
  }
  return true;
}

/// The part's own shape if it is convex, else its hull; an error when the part has no volume or is
/// smaller than a collider may be. `enclosed_m3` is 0 when the hull exceeds the part by more than
/// kNearlyConvex.
Expected<ConvexPart> convexPart(const MeshSurface& mesh) {
  ConvexPart part;
  part.inward = enclosedVolume(mesh).value_or(0.0) < 0.0;
  if (Expected<Shape> itself = convexMesh(mesh.points, mesh.triangles)) {
    part.shape = std::move(*itself);
    part.enclosed_m3 = moments(part.shape).volume_m3;
    return part;
  }
  Expected<StandIn> hull = standIn(mesh);
  if (!hull) return hull.errors();
  const double enclosed_m3 = hull->enclosed_m3.value_or(0.0);
  if (hull->hull_m3 <= kNearlyConvex * enclosed_m3) part.enclosed_m3 = enclosed_m3;
  part.shape = std::move(hull->shape);
  return part;
}

/// One collider for each part, when every part is convex within kNearlyConvex. Empty when a part is
/// not convex, when there is only one part, or when one part is a hollow of another. Parts that
/// have no volume, are smaller than a collider may be, or lie inside another part are left out with
/// a notice.
std::optional<MeshCollider> convexParts(const MeshSurface& mesh, const std::vector<int>& part) {
  const std::vector<MeshSurface> parts = divided(mesh, part);
  if (parts.size() < 2) return std::nullopt;
  // Makes a shape of each part that has volume.
  std::vector<ConvexPart> convex;
  for (const MeshSurface& one : parts) {
    Expected<ConvexPart> found = convexPart(one);
    if (!found) continue;
    if (!(found->enclosed_m3 > 0.0)) return {};
    convex.push_back(std::move(*found));
  }
  const std::size_t with_volume = convex.size();
  if (convex.empty() || !dropInner(convex)) return std::nullopt;
  // Collects the shapes and compares their volume with that of the parts.
  MeshCollider found;
  double is_m3 = 0.0, was_m3 = 0.0;
  for (ConvexPart& one : convex) {
    is_m3 += moments(one.shape).volume_m3;
    was_m3 += one.enclosed_m3;
    found.shapes.push_back(std::move(one.shape));
  }
  if (std::abs(is_m3 / was_m3 - 1.0) > kConvexShare) {
    found.notices.push_back(fileFault(
        "",
        fmt::format(
            "has {} whose convex {}, {}",
            found.shapes.size() == 1 ? "1 part" : fmt::format("{} parts", found.shapes.size()),
            found.shapes.size() == 1 ? "hull takes its place" : "hulls take their place",
            volumeChange(is_m3, was_m3)),
        "where this is too much, give convex parts"));
  }
  const std::size_t inner = with_volume - found.shapes.size(),
                    left_out = parts.size() - with_volume;
  if (inner > 0) {
    found.notices.push_back(
        fileFault("",
                  fmt::format("has {} part{} inside another, left out of {}", inner, plural(inner),
                              parts.size()),
                  "nothing of them is felt; of a hollow, turn the faces the other way"));
  }
  if (left_out > 0) {
    found.notices.push_back(
        fileFault("",
                  fmt::format("has {} part{} without volume or smaller than 1 mm, left out of {}",
                              left_out, plural(left_out), parts.size()),
                  "give them a thickness if they shall be felt"));
  }
  return found;
}

/// Numbers the connected components. Triangles are connected when they belong to one part and share
/// the position of a corner.
std::vector<int> components(const MeshSurface& mesh, const std::vector<int>& part) {
  const std::vector<int> same = welded(mesh);
  std::map<std::pair<int, int>, int> node;  // (part, merged corner) to node of the union-find
  std::vector<int> parent;
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::vector<int> component;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    int first = -1;
    for (const int corner : mesh.triangles[i]) {
      const auto [at, is_new] =
          node.try_emplace({part[i], same[corner]}, static_cast<int>(parent.size()));
      if (is_new) parent.push_back(at->second);
      if (first < 0) first = at->second;
      parent[root(at->second)] = root(first);
    }
    component.push_back(first);
  }
  for (int& c : component) c = root(c);
  return component;
}

/// Numbers the solids of a closed, outward wound surface that touch along edges or faces, as a
/// convex decomposition in one object is. All 0: it is not such a surface.
std::vector<int> touchingSolids(const MeshSurface& mesh) {
  const std::vector<int> same = welded(mesh);
  MeshSurface merged = mesh;
  for (Vector3i& t : merged.triangles) {
    for (int& corner : t) corner = same[corner];
  }
  std::vector<int> solids = shellNumbers(merged);
  solids.resize(mesh.triangles.size());
  return solids;
}

}  // namespace

Shape shapeOf(const MeshSurface& surface) {
  Shape shape;
  shape.type = ShapeType::kConvexMesh;
  shape.points_m = surface.points;
  shape.triangles = surface.triangles;
  return shape;
}

Expected<Shape> convexMesh(const std::vector<Vector3d>& points_m,
                           const std::vector<Vector3i>& triangles) {
  if (auto d = inputFault(points_m, triangles, 2 * kMaxMeshPoints)) return *d;
  WeldedMesh mesh = cleaned(points_m, triangles);
  if (auto d = sizeFault(mesh)) return *d;
  if (mesh.triangles.empty()) return flatFault();
  dropRepeated(mesh);
  windOutward(mesh, mean(mesh.points_m));
  if (auto d = dentFault(mesh)) return *d;

  Shape shape = shapeOf({mesh.points_m, {}});
  std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(shape.triangles),
               [&](const Vector3i& t) { return !isSliver(mesh, t); });
  const double cube_m3 = mesh.size_m * mesh.size_m * mesh.size_m;
  if (moments(shape).volume_m3 < kWeldShare * cube_m3) return flatFault();
  if (auto d = holeFault(mesh)) return *d;
  return shape;
}

Expected<MeshCollider> meshCollider(const MeshFile& file) {
  const MeshSurface& mesh = file.surface;
  if (auto d = inputFault(mesh.points, mesh.triangles, kMaxMeshTriangles)) return *d;
  // Parts are judged one by one below. One that is too large must not be left out as too small.
  WeldedMesh whole;
  for (const Vector3i& t : mesh.triangles) {
    for (const int corner : t) whole.points_m.push_back(mesh.points[corner]);
  }
  whole.size_m = diagonal(whole.points_m);
  const auto size = sizeFault(whole);
  if (size && whole.size_m > 0.0) return *size;
  Expected<Shape> itself = convexMesh(mesh.points, mesh.triangles);
  if (itself) return MeshCollider{{std::move(*itself)}, {}};
  std::vector<int> part = file.part;
  part.resize(mesh.triangles.size());
  const std::vector<int> one(mesh.triangles.size());
  // Tries the file's objects, then the connected pieces of each object, then the connected pieces
  // of the whole surface (some programs divide a surface only by its materials), then solids that
  // touch.
  if (auto found = convexParts(mesh, part)) return std::move(*found);
  if (auto found = convexParts(mesh, components(mesh, part))) return std::move(*found);
  if (auto found = convexParts(mesh, components(mesh, one))) return std::move(*found);
  if (auto found = convexParts(mesh, touchingSolids(mesh))) return std::move(*found);
  Expected<StandIn> hull = standIn(mesh);
  if (!hull) return hull.errors();
  Diagnostic notice = hullNotice(itself.errors().front().problem, *hull);
  return MeshCollider{{std::move(hull->shape)}, {std::move(notice)}};
}

}  // namespace wholehand
