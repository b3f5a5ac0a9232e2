#pragma once

#include "loop/core/geometry.hpp"
#include "schema_enums.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace wholehand {

/// A kind of shapes (docs/adr/0101-shapes-as-sums.md): the hull of its vertices, or the sum of a
/// box, a disk across z and a ball, all about the origin of the shape's frame. Whoever asks for
/// these instead of for the kind holds for a kind that is added, too.
struct ShapeKind {
  std::string_view name;   ///< in files
  const char* length_key;  ///< of its length along z in a scene file; null: it has no length
  bool has_extents, has_disk, has_ball, has_vertices;
};
/// In the order of ShapeType.
inline constexpr std::array<ShapeKind, 5> kShapeKinds{{
    {"box", nullptr, true, false, false, false},
    {"sphere", nullptr, false, false, true, false},
    {"cylinder", "height_m", false, true, false, false},
    {"capsule", "length_m", false, false, true, false},
    {"mesh", nullptr, false, false, false, true},
}};
[[nodiscard]] constexpr bool isShapeType(ShapeType type) noexcept {
  return static_cast<std::size_t>(type) < kShapeKinds.size();
}
[[nodiscard]] std::optional<ShapeType> shapeNamed(std::string_view name);

/// Kind and dimensions of a shape. Real-time safe.
struct ShapeForm {
  ShapeType type = ShapeType::kBox;
  Eigen::Vector3d half_extents_m = Eigen::Vector3d::Zero();  ///< box
  double radius_m = 0.0;                                     ///< sphere, cylinder, capsule
  double length_m = 0.0;  ///< cylinder: height; capsule: distance between the centres of its caps

  /// @pre isShapeType(type)
  [[nodiscard]] const ShapeKind& kind() const noexcept {
    return kShapeKinds[static_cast<std::size_t>(type)];
  }
  [[nodiscard]] bool isMesh() const noexcept { return kind().has_vertices; }
  [[nodiscard]] bool isRound() const noexcept { return kind().has_ball; }  ///< without edges
  [[nodiscard]] bool isCylinder() const noexcept { return kind().has_disk; }
  /// True for a shape whose faces are all flat.
  [[nodiscard]] bool isPolyhedron() const noexcept { return !isRound() && !isCylinder(); }

  // The parts of a sum.
  [[nodiscard]] double disk_m() const noexcept { return kind().has_disk ? radius_m : 0.0; }
  [[nodiscard]] double ball_m() const noexcept { return kind().has_ball ? radius_m : 0.0; }
  [[nodiscard]] Eigen::Vector3d coreBox() const noexcept {
    if (kind().has_extents) return half_extents_m;
    return {0.0, 0.0, kind().length_key != nullptr ? 0.5 * length_m : 0.0};
  }

  /// Half the extent along its own axes [m]; not of a mesh.
  [[nodiscard]] Eigen::Vector3d halfBox() const noexcept {
    const double across_m = disk_m() + ball_m();
    return coreBox() + Eigen::Vector3d(across_m, across_m, ball_m());
  }
  /// Radius of the ball about the origin of its frame that just contains it [m]; 0 for a mesh.
  [[nodiscard]] double outerRadius() const noexcept {
    const Eigen::Vector3d half_m = coreBox();
    return (kind().has_disk ? std::hypot(radius_m, half_m.z()) : half_m.norm()) + ball_m();
  }
};

/// Distance of a point from a surface, negative inside, and its gradient, in the shape's own frame.
struct PointDistance {
  double distance_m;
  Eigen::Vector3d normal;
};

// Of each part of a sum.

inline PointDistance ballDistance(const Eigen::Vector3d& p, double radius_m) noexcept {
  const double away_m = p.norm();
  const Eigen::Vector3d normal =
      away_m > 0.0 ? Eigen::Vector3d(p / away_m) : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  return {away_m - radius_m, normal};
}

inline PointDistance boxDistance(const Eigen::Vector3d& half_m, const Eigen::Vector3d& p) noexcept {
  const Eigen::Vector3d over = p.cwiseAbs() - half_m;
  const Eigen::Vector3d sign(std::copysign(1.0, p.x()), std::copysign(1.0, p.y()),
                             std::copysign(1.0, p.z()));
  const Eigen::Vector3d out = over.cwiseMax(0.0);
  const double away_m = out.norm();
  if (away_m > 0.0) return {away_m, out.cwiseProduct(sign) / away_m};
  int face = 0;
  const double depth_m = over.maxCoeff(&face);
  return {depth_m, sign[face] * Eigen::Vector3d::Unit(face)};
}

inline PointDistance cylinderDistance(double radius_m, double height_m,
                                      const Eigen::Vector3d& p) noexcept {
  const double across = std::sqrt(p.x() * p.x() + p.y() * p.y());
  const Eigen::Vector3d outward = across > 0.0
                                      ? Eigen::Vector3d(p.x() / across, p.y() / across, 0.0)
                                      : Eigen::Vector3d(Eigen::Vector3d::UnitX());
  const Eigen::Vector3d up(0.0, 0.0, std::copysign(1.0, p.z()));
  const double side = across - radius_m;
  const double end = std::abs(p.z()) - height_m / 2.0;
  if (side > 0.0 && end > 0.0) {
    const double away_m = std::sqrt(side * side + end * end);
    return {away_m, (side * outward + end * up) / away_m};
  }
  return side > end ? PointDistance{side, outward} : PointDistance{end, up};
}

/// Of a shape without vertices. Real-time safe.
inline PointDistance pointDistance(const ShapeForm& shape, const Eigen::Vector3d& p) noexcept {
  if (shape.isCylinder()) return cylinderDistance(shape.radius_m, shape.length_m, p);
  if (!shape.isRound()) return boxDistance(shape.half_extents_m, p);
  const double end_m = shape.coreBox().z();
  return ballDistance(p - Eigen::Vector3d(0.0, 0.0, std::clamp(p.z(), -end_m, end_m)),
                      shape.radius_m);
}

/// A collider in its body's frame. Cylinder and capsule lie along the shape frame's z. A disk of a
/// scene file is a cylinder.
struct Shape : ShapeForm {
  std::vector<Eigen::Vector3d> points_m;   ///< convex mesh: hull vertices
  std::vector<Eigen::Vector3i> triangles;  ///< convex mesh: faces, outward
  Pose in_body;
};

/// Moments of a shape at unit density: volume [m³], centre [m] and inertia about the centre [m⁵],
/// in the body frame.
struct ShapeMoments {
  double volume_m3 = 0.0;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_m5 = Eigen::Matrix3d::Zero();
};
[[nodiscard]] ShapeMoments moments(const Shape& shape);

/// The smallest box along the shape's own axes, in its own frame [m].
[[nodiscard]] Eigen::AlignedBox3d ownBox(const Shape& shape);
/// The smallest box along the body's axes that surely contains a shape [m].
[[nodiscard]] Eigen::AlignedBox3d boxOf(const Shape& shape);
/// Points in the body frame whose convex hull contains a shape [m].
[[nodiscard]] std::vector<Eigen::Vector3d> boundingPoints(const Shape& shape);
/// Radius of a ball about the origin of the shape's frame that contains it [m].
[[nodiscard]] double outerRadius(const Shape& shape);

/// Distance from a point to the shape's surface, negative inside [m]; point in the body frame. For
/// a convex mesh, the largest face distance (exact inside and at faces, a lower bound outside).
[[nodiscard]] double signedDistance(const Shape& shape, const Eigen::Vector3d& point_m);

/// The farthest point along a direction, without the ball of the sum; both in the shape's frame.
[[nodiscard]] Eigen::Vector3d coreSupport(const Shape& shape, const Eigen::Vector3d& direction);

}  // namespace wholehand
