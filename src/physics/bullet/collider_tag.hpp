#pragma once

#include "model/scene_model.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace wholehand::bullet {

/// What a collision object belongs to; every collider carries one as its user pointer. Colliders
/// are plain collision objects that we place ourselves: a link of the hand and a body of the scene
/// may carry many, no compound shape is needed (it would allocate at every new pair), and the
/// bodies that move have no shape of their own.
struct ColliderTag {
  int capsule = -1;              ///< of the hand; -1 for a scene's body
  int link = -1;                 ///< of the hand
  int body = -1;                 ///< of the scene
  btRigidBody* rigid = nullptr;  ///< what a scene's collider moves
  const Shape* shape = nullptr;  ///< of a scene's collider, in its own frame; null: no closed form

  [[nodiscard]] bool ofHand() const { return capsule >= 0; }
};

[[nodiscard]] inline const ColliderTag* tagOf(const btCollisionObject* object) {
  return static_cast<const ColliderTag*>(object->getUserPointer());
}

}  // namespace wholehand::bullet
