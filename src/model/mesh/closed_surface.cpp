#include "model/mesh/closed_surface.hpp"

#include "model/mesh/mesh_checks.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace wholehand {

using Eigen::Vector3d;
using Eigen::Vector3i;

namespace {

struct Passes {
  int up = 0, down = 0;  ///< from the smaller index to the larger one, and back
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
      return meshFault(fmt::format("is wound both ways: its faces at {} are", where),
                       "let the modelling program turn all normals outward");
    }
    return meshFault(fmt::format("is not closed, so that it has no volume: {} belongs to {} face{}",
                                 where, faces, faces == 1 ? "" : "s"),
                     "close its holes; a sheet needs a thickness");
  }
  return std::nullopt;
}

}  // namespace

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
  const double volume_m3 = signedVolume(closed.surface);
  if (std::abs(volume_m3) < kWeldShare * std::pow(closed.size_m, 3)) {
    return meshFault("is flat or degenerate: it encloses no volume", "give it a thickness");
  }
  closed.turned = volume_m3 < 0.0;
  closed.volume_m3 = std::abs(volume_m3);
  if (closed.turned) {
    for (Vector3i& t : closed.surface.triangles) std::swap(t[1], t[2]);
  }
  return closed;
}

}  // namespace wholehand
