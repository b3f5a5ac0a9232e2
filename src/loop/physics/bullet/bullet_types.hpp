#pragma once

#include "loop/core/geometry.hpp"
#include "loop/core/world_query.hpp"
#include "loop/model/scene_model.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <LinearMath/btMatrix3x3.h>
#include <LinearMath/btQuaternion.h>
#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

namespace wholehand::bullet {

// Contacts are solved to micrometres; single precision is not enough for that.
static_assert(sizeof(btScalar) == 8, "Bullet must be used in double precision");

[[nodiscard]] inline btVector3 toBt(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
[[nodiscard]] inline Eigen::Vector3d toEigen(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
[[nodiscard]] inline Vec3 toVec3(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

/// The vector, shortened to this length if it is longer.
[[nodiscard]] inline btVector3 atMost(const btVector3& v, double length) noexcept {
  const double is = v.length();
  return is > length ? v * (length / is) : v;
}

[[nodiscard]] inline btMatrix3x3 toBt(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}
[[nodiscard]] inline btQuaternion toBtQuaternion(const Eigen::Matrix3d& m) {
  const Eigen::Quaterniond q(m);
  return {q.x(), q.y(), q.z(), q.w()};
}
[[nodiscard]] inline Pose toPose(const btTransform& at) {
  Pose pose{Eigen::Matrix3d(), toEigen(at.getOrigin())};
  for (int r = 0; r < 3; ++r) pose.rotation.row(r) = toEigen(at.getBasis()[r]);
  return pose;
}
[[nodiscard]] inline btTransform toBt(const Pose& pose) {
  return btTransform(toBt(pose.rotation), toBt(pose.translation_m));
}
/// Pose of a placed body's Bullet frame. @param from_body pose of that frame in the scene's body
/// frame
[[nodiscard]] inline btTransform placedAt(const BodyPlacement& placement, const Pose& from_body) {
  const Eigen::Quaterniond q =
      placement.orientation_xyzw.eigen().normalized() * Eigen::Quaterniond(from_body.rotation);
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), toBt(placement.position_m.eigen()));
}

/// Owner of a collision object; every collider's user pointer refers to one. Colliders are plain
/// collision objects that we place ourselves: links and bodies may have many without a compound
/// shape, which would allocate for every new pair, and moving bodies have no shape of their own.
struct ColliderTag {
  int capsule = -1;              ///< capsule of the hand; -1: scene body
  int link = -1;                 ///< link of the hand
  int body = -1;                 ///< body of the scene
  btRigidBody* rigid = nullptr;  ///< rigid body that a scene collider belongs to
  const Shape* shape = nullptr;  ///< shape of a scene collider, in its own frame; null: no closed
                                 ///< form

  [[nodiscard]] bool ofHand() const { return capsule >= 0; }
};

[[nodiscard]] inline const ColliderTag* tagOf(const btCollisionObject* object) {
  return static_cast<const ColliderTag*>(object->getUserPointer());
}

}  // namespace wholehand::bullet
