#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/model/hand_model.hpp"

#include <memory>

class btMultiBody;

namespace wholehand::test {

/// The same tree of links as a btMultiBody. Bullet's articulated-body algorithm (Featherstone, in
/// link frames, O(n)) is an implementation of the dynamics that shares nothing with ours.
class BulletTwin {
 public:
  explicit BulletTwin(const HandModel& hand);
  ~BulletTwin();

  void setState(const JointPosition& theta, const JointVelocity& theta_dot);
  /// θ̈ under joint torques and gravity.
  [[nodiscard]] Eigen::VectorXd acceleration(const JointEffort& torque,
                                             const Eigen::Vector3d& gravity_m_s2);
  /// M⁻¹ e for joint `joint`.
  [[nodiscard]] Eigen::VectorXd inverseInertiaColumn(int joint);
  /// Centre of mass of a link in the world.
  [[nodiscard]] Eigen::Vector3d linkCom(int link) const;

 private:
  const HandModel* hand_;
  std::unique_ptr<btMultiBody> body_;
};

}  // namespace wholehand::test
