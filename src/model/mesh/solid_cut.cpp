#include "model/mesh/solid_cut.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Vector3d;

using Segment = std::pair<Vector3d, Vector3d>;

/// What is left of a facet behind a plane: at most four corners.
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

}  // namespace

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

}  // namespace wholehand
