#include "loop/physics/bullet/bullet_shapes.hpp"

#include "loop/model/principal_axes.hpp"
#include "loop/physics/bullet/bullet_types.hpp"

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <Eigen/LU>

#include <cmath>

namespace wholehand::bullet {

double contactThreshold() {
  static const double kThreshold_m = gContactBreakingThreshold = 5e-4;
  return kThreshold_m;
}

Pose principalFrame(const SceneBody& body, btVector3& moments) {
  const Eigen::Matrix3d& inertia = body.inertia_kg_m2;
  const double off_diagonal =
      std::abs(inertia(0, 1)) + std::abs(inertia(0, 2)) + std::abs(inertia(1, 2));
  if (body.fixed || off_diagonal <= 1e-12 * inertia.trace()) {
    moments.setValue(inertia(0, 0), inertia(1, 1), inertia(2, 2));
    return {Eigen::Matrix3d::Identity(), body.com_m};
  }
  auto [axes, principal] = principalAxesOf(inertia);
  if (axes.determinant() < 0.0) axes.col(2) = -axes.col(2);
  moments = toBt(principal);
  return {axes, body.com_m};
}

std::unique_ptr<btCollisionShape> makeShape(const Shape& shape) {
  if (!shape.isMesh()) {
    auto sum = constructSum(
        shape, [](auto type, const auto&... dimensions) -> std::unique_ptr<btCollisionShape> {
          return std::make_unique<typename decltype(type)::type>(dimensions...);
        });
    if (!shape.isRound()) sum->setMargin(0.0);  // a margin would round the edges
    return sum;
  }
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Eigen::Vector3d& p : shape.points_m) hull->addPoint(toBt(p), false);
  hull->recalcLocalAabb();
  // Bullet's default margin would enlarge the mesh by 4 cm; the capsules have a margin of their
  // own.
  hull->setMargin(0.0);
  return hull;
}

}  // namespace wholehand::bullet
