#pragma once

#include "dynamics/articulated_body.hpp"
#include "model/hand_model.hpp"
#include "physics/bullet/collider_tag.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <memory>
#include <vector>

namespace wholehand::bullet {

/// The hand in Bullet: an articulated body that moves, and capsules that touch. The capsules are
/// plain collision objects placed by our own kinematics, so that a link may carry many.
class BulletHand {
 public:
  BulletHand(const HandModel& hand, double friction);

  [[nodiscard]] btMultiBody& body() { return *body_; }
  [[nodiscard]] const btMultiBody& body() const { return *body_; }
  [[nodiscard]] const std::vector<std::unique_ptr<btCollisionObject>>& capsules() const {
    return objects_;
  }
  /// Moves every capsule to its link. Real-time safe.
  void placeCapsules(const ArticulatedBody& kinematics) noexcept;

  void readJoints(JointPosition& theta, JointVelocity& theta_dot) const noexcept;
  void writeJoints(const JointPosition& theta, const double* theta_dot) noexcept;
  void addTorque(const JointEffort& torque) noexcept;

 private:
  void addCapsules(double friction);

  const HandModel& hand_;
  std::unique_ptr<btMultiBody> body_;
  std::vector<int> link_of_joint_;
  std::vector<std::unique_ptr<btCapsuleShapeZ>> shapes_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_;
  std::vector<ColliderTag> tags_;
  std::vector<Pose> capsule_in_link_;
};

/// Builds the bare articulated body (no capsules), with all damping off. Tests compare our dynamics
/// with its articulated-body algorithm.
[[nodiscard]] std::unique_ptr<btMultiBody> makeMultiBody(const HandModel& hand);

}  // namespace wholehand::bullet
