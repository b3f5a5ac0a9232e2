#include "files/mesh/shells.hpp"

#include "files/mesh/mesh_checks.hpp"
#include "files/mesh/solid.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr std::size_t kSamples = 50;   ///< approximate number of triangles sampled per shell
constexpr double kInwardShare = 1e-6;  ///< distance of a sample from its triangle, in sizes

/// Union-find of connected triangles.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(int i, int j) { parent_[std::max(find(i), find(j))] = std::min(find(i), find(j)); }

 private:
  std::vector<int> parent_;
};

/// A triangle at an edge.
struct AtEdge {
  int triangle = 0;
  double angle_rad = 0.0;  ///< of its third corner about the edge
};

/// Triangles at an edge, by the direction in which they pass it.
struct Edge {
  std::vector<AtEdge> up, down;  ///< from the smaller index to the larger one, and back
};

/// Angle from one triangle that passes an edge upward through its inner side to one that passes it
/// downward, 0 .. 2π. A triangle that lies on the first one closes another solid: 2π.
double turnOf(const AtEdge& up, const AtEdge& down) {
  constexpr double kTurn = 2.0 * std::numbers::pi, kSame = 1e-6;
  const double turn = std::remainder(up.angle_rad - down.angle_rad, kTurn);
  return turn < kSame ? turn + kTurn : turn;
}

/// Joins each triangle that passes the edge upward with one that passes it downward: already
/// connected pairs first, then with the one that closes the solid behind it.
void joinAtEdge(Edge edge, Sets& sets) {
  for (const AtEdge up : std::exchange(edge.up, {})) {
    const auto same = std::find_if(edge.down.begin(), edge.down.end(), [&](const AtEdge& down) {
      return sets.find(down.triangle) == sets.find(up.triangle);
    });
    if (same == edge.down.end()) {
      edge.up.push_back(up);
    } else {
      edge.down.erase(same);
    }
  }
  for (const AtEdge& up : edge.up) {
    const auto mate = std::min_element(
        edge.down.begin(), edge.down.end(),
        [&](const AtEdge& a, const AtEdge& b) { return turnOf(up, a) < turnOf(up, b); });
    sets.join(up.triangle, mate->triangle);
    edge.down.erase(mate);
  }
}

std::map<std::pair<int, int>, Edge> edgesOf(const MeshSurface& surface) {
  std::map<std::pair<int, int>, Edge> edges;
  for (std::size_t n = 0; n < surface.triangles.size(); ++n) {
    const Vector3i& t = surface.triangles[n];
    for (int k = 0; k < 3; ++k) {
      const int i = t[k], j = t[(k + 1) % 3];
      const Vector3d &a = surface.points[std::min(i, j)], &b = surface.points[std::max(i, j)];
      const Vector3d along = (b - a).normalized(), across = along.unitOrthogonal();
      const Vector3d third = surface.points[t[(k + 2) % 3]] - a;
      Edge& edge = edges[std::minmax(i, j)];
      (i < j ? edge.up : edge.down)
          .push_back(
              {static_cast<int>(n), std::atan2(along.cross(across).dot(third), across.dot(third))});
    }
  }
  return edges;
}

std::vector<std::vector<int>> trianglesOfShells(const MeshSurface& surface) {
  const std::vector<int> number = shellNumbers(surface);
  std::map<int, std::vector<int>> shells;
  for (std::size_t n = 0; n < number.size(); ++n) {
    shells[number[n]].push_back(static_cast<int>(n));
  }
  std::vector<std::vector<int>> lists;
  for (auto& [first, triangles] : shells) lists.push_back(std::move(triangles));
  return lists;
}

/// A closed part of the surface.
struct Shell {
  std::vector<int> triangles;  ///< indices into the surface's triangles
  MeshSurface surface;
  Eigen::AlignedBox3d box;
  double volume_m3 = 0.0;  ///< negative: wound inward
};

std::vector<Shell> shellsOf(const MeshSurface& surface) {
  std::vector<Shell> shells;
  for (std::vector<int>& triangles : trianglesOfShells(surface)) {
    Shell shell;
    std::map<int, int> index;  // corner of the surface to corner of the shell
    for (const int n : triangles) {
      Vector3i corners;
      for (int k = 0; k < 3; ++k) {
        const int corner = surface.triangles[n][k];
        const auto [at, added] = index.emplace(corner, shell.surface.points.size());
        if (added) shell.surface.points.push_back(surface.points[corner]);
        corners[k] = at->second;
      }
      shell.surface.triangles.push_back(corners);
    }
    for (const Vector3d& p : shell.surface.points) shell.box.extend(p);
    const double volume_m3 = signedVolume(shell.surface);
    const double least_m3 = kWeldShare * std::pow(shell.box.diagonal().norm(), 3);
    shell.volume_m3 = std::abs(volume_m3) < least_m3 ? 0.0 : volume_m3;
    shell.triangles = std::move(triangles);
    shells.push_back(std::move(shell));
  }
  return shells;
}

/// True when one shell lies within another, judged at sample points inside it near its triangles.
bool liesWithin(const Shell& inner, const Shell& outer, double size_m) {
  const Vector3d slack = Vector3d::Constant(kWeldShare * size_m);
  const Eigen::AlignedBox3d room(outer.box.min() - slack, outer.box.max() + slack);
  if (!room.contains(inner.box)) return false;
  const SurfaceDistance around(outer.surface);
  const auto& [points, triangles] = inner.surface;
  const double inward_m = (inner.volume_m3 < 0.0 ? 1.0 : -1.0) * kInwardShare * size_m;
  for (std::size_t i = 0; i < triangles.size(); i += triangles.size() / kSamples + 1) {
    const Vector3d &a = points[triangles[i][0]], &b = points[triangles[i][1]],
                   &c = points[triangles[i][2]];
    const Vector3d normal = (b - a).cross(c - a).normalized();
    if (std::abs(around.windings((a + b + c) / 3.0 + inward_m * normal)) < 0.5) return false;
  }
  return true;
}

/// The largest shell that contains this shell; the shell itself when no other contains it.
const Shell& outermostOf(const Shell& shell, const std::vector<Shell>& shells, double size_m) {
  const Shell* outermost = &shell;
  for (const Shell& other : shells) {
    if (std::abs(other.volume_m3) <= std::abs(outermost->volume_m3)) continue;
    if (liesWithin(shell, other, size_m)) outermost = &other;
  }
  return *outermost;
}

}  // namespace

std::vector<int> shellNumbers(const MeshSurface& surface) {
  const std::map<std::pair<int, int>, Edge> edges = edgesOf(surface);
  if (std::any_of(edges.begin(), edges.end(),
                  [](const auto& at) { return at.second.up.size() != at.second.down.size(); })) {
    return {};
  }
  Sets sets(surface.triangles.size());
  for (const auto& [ends, edge] : edges) {
    if (edge.up.size() == 1) sets.join(edge.up[0].triangle, edge.down[0].triangle);
  }
  for (const auto& [ends, edge] : edges) {
    if (edge.up.size() > 1) joinAtEdge(edge, sets);
  }
  std::vector<int> number(surface.triangles.size());
  for (std::size_t n = 0; n < number.size(); ++n) number[n] = sets.find(static_cast<int>(n));
  return number;
}

TurnedShells turnInwardShells(MeshSurface& surface, double size_m) {
  const std::vector<Shell> shells = shellsOf(surface);
  const bool inward = std::any_of(shells.begin(), shells.end(),
                                  [](const Shell& shell) { return shell.volume_m3 < 0.0; });
  if (!inward) return TurnedShells::kNone;
  std::size_t turned = 0;
  for (const Shell& shell : shells) {
    if (outermostOf(shell, shells, size_m).volume_m3 >= 0.0) continue;
    for (const int n : shell.triangles) {
      std::swap(surface.triangles[n][1], surface.triangles[n][2]);
    }
    ++turned;
  }
  if (turned == 0) return TurnedShells::kNone;
  return turned == shells.size() ? TurnedShells::kAll : TurnedShells::kSome;
}

}  // namespace wholehand
