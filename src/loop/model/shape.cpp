#include "loop/model/shape.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

namespace wholehand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

ShapeMoments boxMoments(const Vector3d& half_m) {
  const double volume_m3 = 8.0 * half_m.prod();
  const Vector3d sq = half_m.cwiseAbs2();
  const Vector3d inertia(sq.y() + sq.z(), sq.x() + sq.z(), sq.x() + sq.y());
  return {volume_m3, Vector3d::Zero(), Matrix3d((volume_m3 / 3.0 * inertia).asDiagonal())};
}

ShapeMoments sphereMoments(double radius_m) {
  const double volume_m3 = 4.0 / 3.0 * pi * radius_m * radius_m * radius_m;
  return {volume_m3, Vector3d::Zero(),
          0.4 * volume_m3 * radius_m * radius_m * Matrix3d::Identity()};
}

ShapeMoments cylinderMoments(double radius_m, double height_m) {
  const double r2 = radius_m * radius_m;
  const double volume_m3 = pi * r2 * height_m;
  const double across = volume_m3 * (3.0 * r2 + height_m * height_m) / 12.0;
  return {volume_m3, Vector3d::Zero(),
          Matrix3d(Vector3d(across, across, volume_m3 * r2 / 2.0).asDiagonal())};
}

/// A sphere is a capsule without length.
ShapeMoments capsuleMoments(double radius_m, double length_m) {
  const ShapeMoments rod = cylinderMoments(radius_m, length_m);
  const ShapeMoments ball = sphereMoments(radius_m);
  // The centre of each hemisphere's flat side is L/2 from the centre; its centre of mass is 3r/8
  // beyond.
  const double shift_m2 = length_m * length_m / 4.0 + 3.0 / 8.0 * radius_m * length_m;
  Matrix3d inertia_m5 = rod.inertia_m5 + ball.inertia_m5;
  inertia_m5(0, 0) += ball.volume_m3 * shift_m2;
  inertia_m5(1, 1) += ball.volume_m3 * shift_m2;
  return {rod.volume_m3 + ball.volume_m3, Vector3d::Zero(), inertia_m5};
}

/// Exact integral over the polyhedron: signed tetrahedra from one of its own vertices, which keeps
/// the terms small when the mesh lies far from its frame's origin.
ShapeMoments meshMoments(const Shape& shape) {
  if (shape.points_m.empty()) return {};
  const Vector3d origin = shape.points_m.front();
  double volume_m3 = 0.0;
  Vector3d first = Vector3d::Zero();   // integral of p
  Matrix3d second = Matrix3d::Zero();  // integral of p pᵀ
  for (const Eigen::Vector3i& t : shape.triangles) {
    const Vector3d a = shape.points_m[t[0]] - origin;
    const Vector3d b = shape.points_m[t[1]] - origin;
    const Vector3d c = shape.points_m[t[2]] - origin;
    const Vector3d sum = a + b + c;
    const double v = a.dot(b.cross(c)) / 6.0;
    volume_m3 += v;
    first += v / 4.0 * sum;
    second += v / 20.0 *
              (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  if (!(volume_m3 > 0.0)) return {};
  const Vector3d center = first / volume_m3;
  const Matrix3d central = second - volume_m3 * center * center.transpose();
  return {volume_m3, origin + center, central.trace() * Matrix3d::Identity() - central};
}

double meshDistance(const Shape& shape, const Vector3d& p) {
  double largest = -std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3i& t : shape.triangles) {
    const Vector3d& a = shape.points_m[t[0]];
    const Vector3d normal = (shape.points_m[t[1]] - a).cross(shape.points_m[t[2]] - a).normalized();
    largest = std::max(largest, normal.dot(p - a));
  }
  return largest;
}

ShapeMoments momentsInShapeFrame(const Shape& shape) {
  if (shape.isMesh()) return meshMoments(shape);
  const double height_m = 2.0 * shape.coreBox().z();
  if (shape.isCylinder()) return cylinderMoments(shape.radius_m, height_m);
  if (shape.isRound()) return capsuleMoments(shape.radius_m, height_m);
  return boxMoments(shape.half_extents_m);
}

}  // namespace

std::optional<ShapeType> shapeNamed(std::string_view name) {
  const auto found = std::find_if(kShapeKinds.begin(), kShapeKinds.end(),
                                  [&](const ShapeKind& kind) { return kind.name == name; });
  if (found == kShapeKinds.end()) return std::nullopt;
  return static_cast<ShapeType>(found - kShapeKinds.begin());
}

ShapeMoments moments(const Shape& shape) {
  ShapeMoments m = momentsInShapeFrame(shape);
  const Matrix3d& r = shape.in_body.rotation;
  m.center_m = shape.in_body * m.center_m;
  m.inertia_m5 = r * m.inertia_m5 * r.transpose();
  return m;
}

double signedDistance(const Shape& shape, const Vector3d& point_m) {
  const Vector3d p = shape.in_body.rotation.transpose() * (point_m - shape.in_body.translation_m);
  return shape.isMesh() ? meshDistance(shape, p) : pointDistance(shape, p).distance_m;
}

Eigen::AlignedBox3d ownBox(const Shape& shape) {
  if (shape.points_m.empty()) return {-shape.halfBox(), shape.halfBox()};
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : shape.points_m) box.extend(p);
  return box;
}

std::vector<Vector3d> boundingPoints(const Shape& shape) {
  std::vector<Vector3d> points;
  const auto add = [&](const Vector3d& p) { points.emplace_back(shape.in_body * p); };
  if (shape.isMesh()) {
    for (const Vector3d& p : shape.points_m) add(p);
    return points;
  }
  const Vector3d half_m = shape.halfBox();
  for (int i = 0; i < 8; ++i) {
    const Vector3d sign((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                        (i & 4) != 0 ? 1.0 : -1.0);
    add(sign.cwiseProduct(half_m));
  }
  return points;
}

Eigen::AlignedBox3d boxOf(const Shape& shape) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : boundingPoints(shape)) box.extend(p);
  return box;
}

double outerRadius(const Shape& shape) {
  double radius_m = shape.outerRadius();
  for (const Vector3d& p : shape.points_m) radius_m = std::max(radius_m, p.norm());
  return radius_m;
}

Vector3d coreSupport(const Shape& shape, const Vector3d& direction) {
  const Vector3d& d = direction;
  if (shape.isMesh()) {
    return *std::max_element(
        shape.points_m.begin(), shape.points_m.end(),
        [&](const Vector3d& p, const Vector3d& q) { return p.dot(d) < q.dot(d); });
  }
  const Vector3d half_m = shape.coreBox();
  const double across = std::hypot(d.x(), d.y());
  const double k = across > 0.0 ? shape.disk_m() / across : 0.0;
  return {std::copysign(half_m.x(), d.x()) + k * d.x(),
          std::copysign(half_m.y(), d.y()) + k * d.y(), std::copysign(half_m.z(), d.z())};
}

}  // namespace wholehand
