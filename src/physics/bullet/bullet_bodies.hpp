#pragma once

#include "core/tick_record.hpp"
#include "model/scene_model.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <memory>
#include <vector>

namespace wholehand::bullet {

/// A body of the scene in Bullet. Bullet's body frame is the principal frame of inertia at the
/// centre of mass; `from_body` says where that is in the scene's body frame.
struct SceneBodyInBullet {
  std::vector<std::unique_ptr<btCollisionShape>> shapes;  ///< the last is the body's own
  std::unique_ptr<btRigidBody> rigid;
  Pose from_body;
  btTransform start;  ///< of Bullet's frame

  /// Back to the starting pose, at rest.
  void putAtStart();
};

/// Builds a body at its starting pose. `index` becomes its user index.
[[nodiscard]] SceneBodyInBullet makeBody(const SceneBody& body, int index);

/// Its state: centre of mass and the orientation of the scene's body frame. Real-time safe.
[[nodiscard]] BodyState stateOf(const SceneBodyInBullet& body) noexcept;

}  // namespace wholehand::bullet
