#include "files/mesh/solid.hpp"

#include "files/mesh/mesh_checks.hpp"
#include "files/mesh/shells.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

struct Passes {
  int up = 0, down = 0;  ///< passes from the smaller to the larger vertex index, and back
};

std::optional<Diagnostic> edgeFault(const WeldedMesh& mesh) {
  std::map<std::pair<int, int>, Passes> edges;
  for (const Vector3i& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const int i = t[k], j = t[(k + 1) % 3];
      Passes& passes = edges[std::minmax(i, j)];
      ++(i < j ? passes.up : passes.down);
    }
  }
  for (const auto& [edge, passes] : edges) {
    if (passes.up == passes.down) continue;
    const int faces = passes.up + passes.down;
    const std::string where =
        fmt::format("the edge from {} to {}", place(mesh.points_m[edge.first]),
                    place(mesh.points_m[edge.second]));
    if (faces % 2 == 0) {
      return fileFault("", fmt::format("is wound both ways: its faces at {} are", where),
                       "let the modelling program turn all normals outward");
    }
    return fileFault("",
                     fmt::format("is not closed, so that it has no volume: {} belongs to {} face{}",
                                 where, faces, faces == 1 ? "" : "s"),
                     "close its holes; a sheet needs a thickness");
  }
  return std::nullopt;
}

using Segment = std::pair<Vector3d, Vector3d>;

/// The part of a facet behind a plane: at most four corners.
struct Polygon {
  std::array<Vector3d, 4> corners_m;
  std::array<bool, 4> on_plane{};
  int count = 0;
  void add(const Vector3d& p, bool on) {
    corners_m[count] = p;
    on_plane[count++] = on;
  }
};

Polygon clip(const Facet& facet, const std::array<double, 3>& distance_m) {
  Polygon polygon;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Vector3d &a = facet.corners_m[k], &b = facet.corners_m[next];
    const double da = distance_m[k], db = distance_m[next];
    if (da <= 0.0) polygon.add(a, da == 0.0);
    if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) polygon.add(crossing(a, da, b, db), true);
  }
  return polygon;
}

void addFacets(const Polygon& polygon, bool on_cut, std::vector<Facet>& out) {
  const auto& p = polygon.corners_m;
  out.push_back({{p[0], p[1], p[2]}, on_cut});
  if (polygon.count == 4) out.push_back({{p[0], p[2], p[3]}, on_cut});
}

void addSegments(const Polygon& polygon, std::vector<Segment>& out) {
  for (int k = 0; k < polygon.count; ++k) {
    const int next = (k + 1) % polygon.count;
    if (!polygon.on_plane[k] || !polygon.on_plane[next]) continue;
    out.emplace_back(polygon.corners_m[k], polygon.corners_m[next]);
  }
}

constexpr std::size_t kMostPlanes = 16;
/// Edges with smaller angles belong to the facets of round surfaces.
constexpr double kReflexSine = 0.02;
constexpr double kSame = 1e-6;  ///< planes are equal within this difference of normals, and of
                                ///< offsets as a share of the size

Vector3d normalOf(const MeshSurface& s, const Vector3i& t) {
  return (s.points[t[1]] - s.points[t[0]]).cross(s.points[t[2]] - s.points[t[0]]).normalized();
}

constexpr int kLeaf = 4;  ///< boxes with at most so many triangles are not divided

double squaredDistanceToSegment(const Vector3d& a, const Vector3d& b, const Vector3d& p) {
  const Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (a + share * along - p).squaredNorm();
}

}  // namespace

using Eigen::Vector3d;
using Eigen::Vector3i;

double signedVolume(const MeshSurface& surface) {
  if (surface.points.empty()) return 0.0;
  const Vector3d& origin = surface.points.front();
  double six_fold = 0.0;
  for (const Vector3i& t : surface.triangles) {
    const Vector3d a = surface.points[t[0]] - origin, b = surface.points[t[1]] - origin;
    six_fold += a.dot(b.cross(surface.points[t[2]] - origin));
  }
  return six_fold / 6.0;
}

Expected<ClosedSurface> closedSurface(const std::vector<Vector3d>& points_m,
                                      const std::vector<Vector3i>& triangles) {
  if (auto d = inputFault(points_m, triangles, kMaxSolidTriangles)) {
    if (triangles.size() > std::size_t{kMaxSolidTriangles})
      d->remedy = fmt::format("may have {} at most: simplify it", kMaxSolidTriangles);
    return *d;
  }
  WeldedMesh mesh = cleaned(points_m, triangles);
  if (auto d = sizeFault(mesh)) return *d;
  if (auto d = edgeFault(mesh)) return *d;
  ClosedSurface closed;
  closed.size_m = mesh.size_m;
  closed.surface = {std::move(mesh.points_m), std::move(mesh.triangles)};
  closed.turned = turnInwardShells(closed.surface, closed.size_m);
  closed.volume_m3 = signedVolume(closed.surface);
  if (closed.volume_m3 < kWeldShare * std::pow(closed.size_m, 3)) return flatFault();
  return closed;
}

Vector3d crossing(const Vector3d& a, double da, const Vector3d& b, double db) {
  if (!std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end())) {
    return b + db / (db - da) * (a - b);
  }
  return a + da / (da - db) * (b - a);
}

std::vector<Facet> cutBehind(const std::vector<Facet>& facets, const CutPlane& plane,
                             double snap_m) {
  std::vector<Facet> behind;
  std::vector<Segment> segments;
  for (const Facet& facet : facets) {
    std::array<double, 3> distance_m{};
    for (std::size_t k = 0; k < 3; ++k) {
      distance_m[k] = plane.distance_m(facet.corners_m[k]);
      if (std::abs(distance_m[k]) <= snap_m) distance_m[k] = 0.0;
    }
    if (*std::min_element(distance_m.begin(), distance_m.end()) >= 0.0) continue;
    const Polygon polygon = clip(facet, distance_m);
    addFacets(polygon, facet.on_cut, behind);
    addSegments(polygon, segments);
  }
  if (segments.empty()) return behind;
  const Vector3d& corner = segments.front().first;
  for (const auto& [from, to] : segments) {
    if (from != corner && to != corner) behind.push_back({{corner, to, from}, true});
  }
  return behind;
}

double volumeOf(const std::vector<Facet>& facets) {
  if (facets.empty()) return 0.0;
  const Vector3d& origin = facets.front().corners_m[0];
  double six_fold = 0.0;
  for (const Facet& f : facets) {
    const Vector3d a = f.corners_m[0] - origin, b = f.corners_m[1] - origin;
    six_fold += a.dot(b.cross(f.corners_m[2] - origin));
  }
  return six_fold / 6.0;
}

std::vector<FeaturePlane> featurePlanes(const MeshSurface& surface) {
  std::map<std::pair<int, int>, int>
      triangle_at;  // triangle that passes the edge in this direction
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const Vector3i& t = surface.triangles[i];
    for (int k = 0; k < 3; ++k) triangle_at[{t[k], t[(k + 1) % 3]}] = static_cast<int>(i);
  }
  std::vector<FeaturePlane> features;
  for (const auto& [edge, triangle] : triangle_at) {
    const auto other = triangle_at.find({edge.second, edge.first});
    if (other == triangle_at.end()) continue;
    const Vector3d &a = surface.points[edge.first], &b = surface.points[edge.second];
    const Vector3d normal = normalOf(surface, surface.triangles[triangle]);
    const Vector3d next = normalOf(surface, surface.triangles[other->second]);
    const double sine = -normal.cross(next).dot((b - a).normalized());  // > 0: reflex
    if (!(sine > kReflexSine)) continue;
    features.push_back({{normal, normal.dot(a)}, (a + b) / 2.0, sine * (b - a).norm()});
  }
  return features;
}

std::vector<Candidate> candidatesAtEdges(const std::vector<FeaturePlane>& features,
                                         const std::vector<CutPlane>& cell, double size_m) {
  std::vector<FeaturePlane> planes;
  double all_m = 0.0;  // counts every edge twice, once for each of its planes
  for (const FeaturePlane& feature : features) {
    const bool within = std::all_of(cell.begin(), cell.end(), [&](const CutPlane& c) {
      return c.distance_m(feature.edge_middle_m) < -kSame * size_m;
    });
    if (!within) continue;
    all_m += feature.weight_m;
    const auto same = std::find_if(planes.begin(), planes.end(), [&](const FeaturePlane& p) {
      return (p.plane.normal - feature.plane.normal).norm() < kSame &&
             std::abs(p.plane.offset_m - feature.plane.offset_m) < kSame * size_m;
    });
    if (same == planes.end()) {
      planes.push_back(feature);
    } else {
      same->weight_m += feature.weight_m;
    }
  }
  std::stable_sort(planes.begin(), planes.end(), [](const FeaturePlane& a, const FeaturePlane& b) {
    return a.weight_m > b.weight_m;
  });
  planes.resize(std::min(planes.size(), kMostPlanes));
  std::vector<Candidate> candidates;
  for (const FeaturePlane& p : planes) candidates.push_back({p.plane, 2.0 * p.weight_m / all_m});
  return candidates;
}

SurfaceDistance::SurfaceDistance(const MeshSurface& surface)
    : surface_(surface), order_(surface.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(2 * order_.size());
  build(0, static_cast<int>(order_.size()));
}

int SurfaceDistance::build(int first, int count) {
  const auto summed_corners = [this](int triangle) -> Vector3d {
    const Vector3i& t = surface_.triangles[triangle];
    return surface_.points[t[0]] + surface_.points[t[1]] + surface_.points[t[2]];
  };
  const int index = static_cast<int>(nodes_.size());
  Node node{{}, first, count};
  Eigen::AlignedBox3d centers;
  const auto begin = order_.begin() + first;
  for (auto at = begin; at != begin + count; ++at) {
    for (const int corner : surface_.triangles[*at]) node.box.extend(surface_.points[corner]);
    centers.extend(summed_corners(*at));
  }
  nodes_.push_back(node);
  if (count <= kLeaf) return index;
  int axis = 0;
  centers.sizes().maxCoeff(&axis);
  std::sort(begin, begin + count, [&](int i, int j) {
    const double a = summed_corners(i)[axis], b = summed_corners(j)[axis];
    return a != b ? a < b : i < j;
  });
  const int left = build(first, count / 2);
  const int right = build(first + count / 2, count - count / 2);
  nodes_[index].left = left;
  nodes_[index].right = right;
  return index;
}

double SurfaceDistance::squaredDistance(int triangle, const Vector3d& p) const {
  const Vector3i& t = surface_.triangles[triangle];
  const Vector3d &a = surface_.points[t[0]], &b = surface_.points[t[1]], &c = surface_.points[t[2]];
  const Vector3d normal = (b - a).cross(c - a);
  const bool above = normal.dot((b - a).cross(p - a)) >= 0.0 &&
                     normal.dot((c - b).cross(p - b)) >= 0.0 &&
                     normal.dot((a - c).cross(p - c)) >= 0.0;
  if (above && normal.squaredNorm() > 0.0) {
    const double height = normal.dot(p - a);
    return height * height / normal.squaredNorm();
  }
  return std::min({squaredDistanceToSegment(a, b, p), squaredDistanceToSegment(b, c, p),
                   squaredDistanceToSegment(c, a, p)});
}

void SurfaceDistance::search(int index, const Vector3d& p, double& nearest_m2) const {
  const Node& node = nodes_[index];
  if (node.left < 0) {
    for (int i = node.first; i < node.first + node.count; ++i) {
      nearest_m2 = std::min(nearest_m2, squaredDistance(order_[i], p));
    }
    return;
  }
  const double left_m2 = nodes_[node.left].box.squaredExteriorDistance(p);
  const double right_m2 = nodes_[node.right].box.squaredExteriorDistance(p);
  const bool left_first = left_m2 <= right_m2;
  if (std::min(left_m2, right_m2) < nearest_m2) {
    search(left_first ? node.left : node.right, p, nearest_m2);
  }
  if (std::max(left_m2, right_m2) < nearest_m2) {
    search(left_first ? node.right : node.left, p, nearest_m2);
  }
}

double SurfaceDistance::to(const Vector3d& p) const {
  double nearest_m2 = std::numeric_limits<double>::infinity();
  search(0, p, nearest_m2);
  return std::sqrt(nearest_m2);
}

// Solid angles by the formula of van Oosterom and Strackee, 1983.
double SurfaceDistance::windings(const Vector3d& p) const {
  double half_angles = 0.0;
  for (const Vector3i& t : surface_.triangles) {
    const Vector3d a = surface_.points[t[0]] - p, b = surface_.points[t[1]] - p;
    const Vector3d c = surface_.points[t[2]] - p;
    const double na = a.norm(), nb = b.norm(), nc = c.norm();
    half_angles +=
        std::atan2(a.dot(b.cross(c)), na * nb * nc + a.dot(b) * nc + b.dot(c) * na + c.dot(a) * nb);
  }
  return half_angles / (2.0 * std::numbers::pi);
}

}  // namespace wholehand
