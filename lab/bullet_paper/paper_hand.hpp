#pragma once

#include "loop/core/real_time.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/physics_world.hpp"

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyGearConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <array>
#include <memory>
#include <vector>

namespace wholehand::bullet_paper {

/// Method that keeps the following joints on the synergy.
enum class PaperCoupling {
  kResets,  ///< joints are reset after each step
  kGears    ///< btMultiBodyGearConstraint to the joint that leads their axis
};

/// The hand as Bullet's articulated body. One joint per axis leads and receives the torque. With
/// resets, the other joints have the motor that Bullet's server gives every joint and are reset to
/// θ₀ + G q_s after each step. With gears, each of them is geared to the leading joint and keeps
/// the position after a step. Real-time safe except for construction.
class PaperHand {
 public:
  /// @pre hand outlives this
  PaperHand(const HandModel& hand, double friction, PaperCoupling coupling);

  /// Errors for axes that drive no joint alone and therefore have no leading joint; with gears also
  /// for joints that follow more than one axis.
  [[nodiscard]] static Diagnostics refuse(const HandModel& hand, PaperCoupling coupling);

  [[nodiscard]] btMultiBody& body() { return *body_; }
  /// The motors or gears.
  [[nodiscard]] std::vector<btMultiBodyConstraint*> constraints() const;
  [[nodiscard]] const std::vector<std::unique_ptr<btMultiBodyLinkCollider>>& capsules() const {
    return capsules_;
  }
  [[nodiscard]] bool isPalm(int capsule) const;

  /// Sets all joints to the synergy and the capsules to their links.
  WHOLEHAND_RT void put(const AxisPosition& q_s, const AxisVelocity& qd_s) noexcept;
  /// Call after a step: resets the joints, or with gears moves the capsules to the joints' poses.
  WHOLEHAND_RT void settle(const AxisPosition& q_s, const AxisVelocity& qd_s) noexcept;
  /// Reads all joints.
  WHOLEHAND_RT void readJoints(JointPosition& theta, JointVelocity& theta_dot) const noexcept;
  /// Reads the leading joints. Returns the largest |θ − (θ₀ + G q_s)|.
  WHOLEHAND_RT double take(AxisPosition& q_s, AxisVelocity& qd_s) const noexcept;
  /// Sets torques and motors for the next step. @param qd_s velocity of the hand after the step if
  /// it had no contacts
  WHOLEHAND_RT void drive(const JointEffort& torque, const AxisVelocity& qd_s) noexcept;

 private:
  void addCapsules(double friction);
  void addMotors();
  void addGears();
  [[nodiscard]] bool leads(int joint) const;
  void placeCapsules(const JointPosition& theta) noexcept;

  const HandModel* hand_;
  PaperCoupling coupling_;
  Synergy synergy_;
  ArticulatedBody kinematics_;
  std::unique_ptr<btMultiBody> body_;
  std::array<int, kMaxJoints> link_of_joint_{};
  std::array<int, kMaxAxes> leading_{};
  std::vector<std::unique_ptr<btMultiBodyJointMotor>> motors_;
  std::vector<std::unique_ptr<btMultiBodyGearConstraint>> gears_;
  std::vector<int> following_;  ///< indices of the following joints, in the order of the motors
  std::vector<bullet::ColliderTag> tags_;
  std::vector<std::unique_ptr<btCapsuleShapeZ>> shapes_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> capsules_;
  std::vector<Pose> capsule_in_link_;
};

}  // namespace wholehand::bullet_paper
