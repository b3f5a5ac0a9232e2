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

/// How the joints that follow are kept on the synergy.
enum class PaperCoupling {
  kResets,  ///< put back after each step
  kGears    ///< btMultiBodyGearConstraint to the joint that leads their axis
};

/// The hand as Bullet's articulated body. One joint per axis leads and takes torque. With resets,
/// the others have the motor that Bullet's server gives every joint, and are reset to θ₀ + G q_s
/// after each step; with gears, each is geared to the leading one and stays where a step leaves it.
/// Real-time safe except for construction.
class PaperHand {
 public:
  /// @pre hand outlives this
  PaperHand(const HandModel& hand, double friction, PaperCoupling coupling);

  /// Errors for axes that drive no joint alone, and so have no leading joint; for gears also for
  /// joints that follow more than one axis.
  [[nodiscard]] static Diagnostics refuse(const HandModel& hand, PaperCoupling coupling);

  [[nodiscard]] btMultiBody& body() { return *body_; }
  /// Motors or gears.
  [[nodiscard]] std::vector<btMultiBodyConstraint*> constraints() const;
  [[nodiscard]] const std::vector<std::unique_ptr<btMultiBodyLinkCollider>>& capsules() const {
    return capsules_;
  }
  [[nodiscard]] bool isPalm(int capsule) const;

  /// Sets all joints to the synergy and the capsules to their links.
  WHOLEHAND_RT void put(const AxisPosition& q_s, const AxisVelocity& qd_s) noexcept;
  /// After a step: puts the joints back, or with gears the capsules to where the joints are.
  WHOLEHAND_RT void settle(const AxisPosition& q_s, const AxisVelocity& qd_s) noexcept;
  /// Reads all joints.
  WHOLEHAND_RT void readJoints(JointPosition& theta, JointVelocity& theta_dot) const noexcept;
  /// Reads the leading joints. Returns the largest |θ − (θ₀ + G q_s)|.
  WHOLEHAND_RT double take(AxisPosition& q_s, AxisVelocity& qd_s) const noexcept;
  /// Sets torques and motors for the next step. @param qd_s of the hand after it without contacts
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
  std::vector<int> following_;  ///< joints, in the order of the motors
  std::vector<bullet::ColliderTag> tags_;
  std::vector<std::unique_ptr<btCapsuleShapeZ>> shapes_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> capsules_;
  std::vector<Pose> capsule_in_link_;
};

}  // namespace wholehand::bullet_paper
