#include "model/mesh/feature_planes.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr std::size_t kMostPlanes = 16;
constexpr double kReflexSine = 0.02;  ///< smaller angles are those of round surfaces
constexpr double kSame = 1e-6;        ///< of normals, and of the size: one plane

Vector3d normalOf(const MeshSurface& s, const Vector3i& t) {
  return (s.points[t[1]] - s.points[t[0]]).cross(s.points[t[2]] - s.points[t[0]]).normalized();
}

}  // namespace

std::vector<FeaturePlane> featurePlanes(const MeshSurface& surface) {
  std::map<std::pair<int, int>, int> triangle_at;  // the one that passes the edge in this direction
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
  double all_m = 0.0;  // of every edge twice, once for each of its planes
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

}  // namespace wholehand
