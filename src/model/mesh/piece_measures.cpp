#include "model/mesh/piece_measures.hpp"

#include "model/mesh/solid_cut.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int kSamplesAcross = 40;  ///< of the solid's size, on a surface

/// Points on a triangle, about `apart_m` from each other.
template <class Take>
void forSamples(const Vector3d& a, const Vector3d& b, const Vector3d& c, double apart_m,
                Take take) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const int n = std::max(2, static_cast<int>(std::ceil(longest / apart_m)));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) take(a + (i * (b - a) + j * (c - a)) / n);
  }
}

}  // namespace

double farthestOutside(const MeshSurface& piece, const ClosedSurface& solid,
                       const SurfaceDistance& distance, double small_m) {
  std::vector<std::pair<double, Vector3d>> far;
  for (const Vector3i& t : piece.triangles) {
    forSamples(piece.points[t[0]], piece.points[t[1]], piece.points[t[2]],
               solid.size_m / kSamplesAcross, [&](const Vector3d& p) {
                 if (const double d = distance.to(p); d > small_m) far.emplace_back(d, p);
               });
  }
  std::sort(far.begin(), far.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [d, p] : far) {
    if (distance.windings(p) < 0.5) return d;
  }
  return 0.0;
}

double farthestMissing(const ClosedSurface& solid, const MeshSurface& pieces) {
  const SurfaceDistance distance(pieces);
  double farthest = 0.0;
  for (const Vector3i& t : solid.surface.triangles) {
    const auto& points = solid.surface.points;
    forSamples(points[t[0]], points[t[1]], points[t[2]], solid.size_m / kSamplesAcross,
               [&](const Vector3d& p) {
                 const double d = distance.to(p);
                 if (d > farthest && distance.windings(p) < 0.5) farthest = d;
               });
  }
  return farthest;
}

double overlapOf(const MeshSurface& a, const MeshSurface& b, double snap_m) {
  std::vector<Facet> facets;
  for (const Vector3i& t : a.triangles) {
    facets.push_back({{a.points[t[0]], a.points[t[1]], a.points[t[2]]}, false});
  }
  for (const Vector3i& t : b.triangles) {
    const Vector3d area = (b.points[t[1]] - b.points[t[0]]).cross(b.points[t[2]] - b.points[t[0]]);
    if (!(area.norm() > 0.0) || facets.empty()) continue;
    const Vector3d normal = area.normalized();
    facets = cutBehind(facets, {normal, normal.dot(b.points[t[0]])}, snap_m);
  }
  return std::max(volumeOf(facets), 0.0);
}

double shareInside(const ClosedSurface& solid, const SurfaceDistance& distance) {
  const auto& s = solid.surface;
  const std::size_t step = s.triangles.size() / 200 + 1;
  int inside = 0, count = 0;
  for (std::size_t i = 0; i < s.triangles.size(); i += step) {
    const Vector3i& t = s.triangles[i];
    const Vector3d &a = s.points[t[0]], &b = s.points[t[1]], &c = s.points[t[2]];
    const Vector3d normal = (b - a).cross(c - a).normalized();
    const Vector3d above = (a + b + c) / 3.0 + 1e-6 * solid.size_m * normal;
    inside += distance.windings(above) > 0.5 ? 1 : 0;
    ++count;
  }
  return static_cast<double>(inside) / count;
}

}  // namespace wholehand
