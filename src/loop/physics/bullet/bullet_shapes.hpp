#pragma once

#include "loop/core/geometry.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/bullet/bullet_types.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <LinearMath/btVector3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <type_traits>

namespace wholehand::bullet {

/// Contact threshold: surfaces nearer than this make a contact point; boxes are padded by it [m].
/// Bullet keeps it in a global variable, so it is one constant, which the first call sets.
[[nodiscard]] double contactThreshold();

/// Bullet's frame of a body: centre of mass, principal axes. A diagonal inertia keeps its axes, so
/// that a box is not rotated by 90 degrees.
/// @param moments of inertia about these axes; 0 for a fixed body
[[nodiscard]] Pose principalFrame(const SceneBody& body, btVector3& moments);

/// Constructs the shape of a sum in its own frame by `make(std::type_identity<Shape>, dimensions
/// ..)`. Real-time safe if `make` is. @pre the form has no vertices
template <class Make>
auto constructSum(const ShapeForm& form, const Make& make) {
  const btVector3 half_m = toBt(form.halfBox());
  if (form.isCylinder()) return make(std::type_identity<btCylinderShapeZ>{}, half_m);
  if (!form.isRound()) return make(std::type_identity<btBoxShape>{}, half_m);
  if (form.coreBox().z() == 0.0) return make(std::type_identity<btSphereShape>{}, form.radius_m);
  return make(std::type_identity<btCapsuleShapeZ>{}, form.radius_m, form.length_m);
}

/// Creates the shape in its own frame.
[[nodiscard]] std::unique_ptr<btCollisionShape> makeShape(const Shape& shape);

/// A collider with the data of its shape: vertices, or the parts of a sum.
struct Convex {
  const Shape& form;
  const btTransform& at;
  const Eigen::Vector3d half_m;
  const double disk_m, ball_m;
  const btVector3* points = nullptr;  ///< vertices of a convex mesh
  int point_count = 0;

  Convex(const btCollisionObject& object, const Shape& shape)
      : form(shape),
        at(object.getWorldTransform()),
        half_m(shape.coreBox()),
        disk_m(shape.disk_m()),
        ball_m(shape.ball_m()) {
    const btCollisionShape& is = *object.getCollisionShape();
    if (is.getShapeType() == CONVEX_HULL_SHAPE_PROXYTYPE) {
      const auto& hull = static_cast<const btConvexHullShape&>(is);
      points = hull.getUnscaledPoints();
      point_count = hull.getNumPoints();
    } else if (is.getShapeType() == CONVEX_POINT_CLOUD_SHAPE_PROXYTYPE) {
      const auto& cloud = static_cast<const btConvexPointCloudShape&>(is);
      points = cloud.getUnscaledPoints();
      point_count = cloud.getNumPoints();
    }
  }
};

/// Largest extent of a shape along a direction in its own frame.
inline double reachAlong(const Convex& of, const btVector3& d) {
  if (of.form.isMesh()) {
    double most = -1e30;
    for (int i = 0; i < of.point_count; ++i) most = std::max(most, of.points[i].dot(d));
    return most;
  }
  const double core_m = std::abs(d.x()) * of.half_m.x() + std::abs(d.y()) * of.half_m.y() +
                        std::abs(d.z()) * of.half_m.z();
  if (of.disk_m > 0.0) return of.disk_m * std::hypot(d.x(), d.y()) + core_m;
  return of.ball_m > 0.0 ? of.ball_m * d.length() + core_m : core_m;
}

/// Calls `take` with each corner of a shape that may be farthest along d. Corners and d are in the
/// shape's own frame.
template <class Take>
void eachCorner(const Convex& of, const btVector3& d, const Take& take) {
  const Eigen::Vector3d& half = of.half_m;
  if (of.form.isMesh()) {
    for (int i = 0; i < of.point_count; ++i) take(of.points[i]);
  } else if (of.disk_m > 0.0) {
    // If d points mainly along the axis: sixteen points of the end's rim, one of which is
    // farthest along d. Otherwise a line along the side.
    constexpr double kUpright = 1e-7;  // sine of a tilt below which it counts as upright
    const double across = std::hypot(d.x(), d.y());
    const bool leans = across > kUpright;
    const double c = leans ? d.x() / across : 1.0, s = leans ? d.y() / across : 0.0;
    constexpr double kA = 0.92387953251128674, kB = 0.70710678118654752, kC = 0.38268343236508977;
    constexpr std::array<double, 20> kCosine{1,   kA,  kB, kC, 0,  -kC, -kB, -kA, -1, -kA,
                                             -kB, -kC, 0,  kC, kB, kA,  1,   kA,  kB, kC};
    const bool on_end = std::abs(d.z()) > across;
    for (const double end : {-1.0, 1.0}) {
      if (on_end && end * d.z() < 0.0) continue;
      for (int i = 0; i < (on_end ? 16 : 1); ++i) {
        const double x = kCosine[i], y = -kCosine[i + 4];
        take(btVector3(of.disk_m * (c * x - s * y), of.disk_m * (s * x + c * y), end * half.z()));
      }
    }
  } else if (of.ball_m > 0.0) {
    if (half.z() > 0.0) take(d * of.ball_m + btVector3(0, 0, -half.z()));
    take(d * of.ball_m + btVector3(0, 0, half.z()));
  } else {
    for (int i = 0; i < 8; ++i) {
      take(btVector3((i & 1) != 0 ? half.x() : -half.x(), (i & 2) != 0 ? half.y() : -half.y(),
                     (i & 4) != 0 ? half.z() : -half.z()));
    }
  }
}

}  // namespace wholehand::bullet
