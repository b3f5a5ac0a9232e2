#pragma once

#include "model/scene/scene_model.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace wholehand::bullet {

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
