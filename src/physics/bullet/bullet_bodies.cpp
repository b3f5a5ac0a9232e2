#include "physics/bullet/bullet_bodies.hpp"

#include "physics/bullet/bullet_types.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <Eigen/Eigenvalues>

#include <cmath>

namespace wholehand::bullet {
namespace {

// Frame in which Bullet sees the body: centre of mass, principal axes. Where the inertia is
// diagonal already the axes stay, so that a box is a box and not a box turned by 90 degrees.
Pose principalFrame(const SceneBody& body, btVector3& moments) {
  const Eigen::Matrix3d& inertia = body.inertia_kg_m2;
  const double off_diagonal =
      std::abs(inertia(0, 1)) + std::abs(inertia(0, 2)) + std::abs(inertia(1, 2));
  if (body.fixed || off_diagonal <= 1e-12 * inertia.trace()) {
    moments.setValue(inertia(0, 0), inertia(1, 1), inertia(2, 2));
    return {Eigen::Matrix3d::Identity(), body.com_m};
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) = -axes.col(2);
  moments = toBt(Eigen::Vector3d(solver.eigenvalues()));
  return {axes, body.com_m};
}

// `at` is the shape's frame in Bullet's body frame; a hull absorbs it into its points.
std::unique_ptr<btCollisionShape> makeShape(const Shape& shape, const Pose& at) {
  switch (shape.type) {
    case ShapeType::kBox:
      return std::make_unique<btBoxShape>(toBt(shape.half_extents_m));
    case ShapeType::kSphere:
      return std::make_unique<btSphereShape>(shape.radius_m);
    case ShapeType::kCylinder:
      return std::make_unique<btCylinderShapeZ>(
          btVector3(shape.radius_m, shape.radius_m, shape.length_m / 2.0));
    case ShapeType::kCapsule:
      return std::make_unique<btCapsuleShapeZ>(shape.radius_m, shape.length_m);
    case ShapeType::kConvexMesh: {
      auto hull = std::make_unique<btConvexHullShape>();
      for (const Eigen::Vector3d& p : shape.points_m)
        hull->addPoint(toBt(Eigen::Vector3d(at * p)), false);
      hull->recalcLocalAabb();
      // The default margin would swell the mesh by 4 cm; the capsules bring a margin of their own.
      hull->setMargin(0.0);
      return hull;
    }
  }
  return nullptr;
}

bool isIdentity(const Pose& pose) {
  return pose.rotation.isIdentity(1e-12) && pose.translation_m.isZero(1e-12);
}

}  // namespace

SceneBodyInBullet makeBody(const SceneBody& body, int index) {
  SceneBodyInBullet out;
  btVector3 moments(0, 0, 0);
  out.from_body = principalFrame(body, moments);
  const Pose to_bullet = out.from_body.inverse();
  const auto placed = [&](const Shape& s) { return to_bullet * s.in_body; };
  const bool is_hull = body.shapes[0].type == ShapeType::kConvexMesh;
  if (body.shapes.size() == 1 && (is_hull || isIdentity(placed(body.shapes[0])))) {
    out.shapes.push_back(makeShape(body.shapes[0], placed(body.shapes[0])));
  } else {
    auto compound = std::make_unique<btCompoundShape>();
    for (const Shape& shape : body.shapes) {
      const Pose at = placed(shape);
      out.shapes.push_back(makeShape(shape, at));
      const bool absorbed = shape.type == ShapeType::kConvexMesh;
      compound->addChildShape(absorbed ? btTransform::getIdentity() : toBt(at),
                              out.shapes.back().get());
    }
    out.shapes.push_back(std::move(compound));
  }
  const double mass = body.fixed ? 0.0 : body.mass_kg;
  btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, out.shapes.back().get(),
                                                body.fixed ? btVector3(0, 0, 0) : moments);
  out.rigid = std::make_unique<btRigidBody>(info);
  out.start = toBt(body.pose * out.from_body);
  out.putAtStart();
  out.rigid->setUserIndex(index);
  // Bullet multiplies the two coefficients of a pair; the roots make equal pairs come out true.
  out.rigid->setFriction(std::sqrt(body.friction));
  out.rigid->setDamping(body.linear_damping_per_s, 0.0);
  out.rigid->setActivationState(DISABLE_DEACTIVATION);
  out.rigid->setCollisionFlags(out.rigid->getCollisionFlags() |
                               btCollisionObject::CF_HAS_FRICTION_ANCHOR);
  return out;
}

void SceneBodyInBullet::putAtStart() {
  rigid->setWorldTransform(start);
  rigid->setInterpolationWorldTransform(start);
  rigid->setLinearVelocity(btVector3(0, 0, 0));
  rigid->setAngularVelocity(btVector3(0, 0, 0));
  rigid->setInterpolationLinearVelocity(btVector3(0, 0, 0));
  rigid->setInterpolationAngularVelocity(btVector3(0, 0, 0));
  rigid->clearForces();
}

BodyState stateOf(const SceneBodyInBullet& body) noexcept {
  const btTransform& at = body.rigid->getWorldTransform();
  const btQuaternion q = at.getRotation();
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()) *
      Eigen::Quaterniond(Eigen::Matrix3d(body.from_body.rotation.transpose()));
  return {toVec3(at.getOrigin()), QuatXyzw::from(turned), toVec3(body.rigid->getLinearVelocity()),
          toVec3(body.rigid->getAngularVelocity())};
}

}  // namespace wholehand::bullet
