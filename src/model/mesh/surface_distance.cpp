#include "model/mesh/surface_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace wholehand {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int kLeaf = 4;  ///< triangles of a box that is not divided further

double squaredDistanceToSegment(const Vector3d& a, const Vector3d& b, const Vector3d& p) {
  const Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (a + share * along - p).squaredNorm();
}

}  // namespace

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
