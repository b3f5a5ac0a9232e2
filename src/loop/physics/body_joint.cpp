#include "loop/physics/body_joint.hpp"

#include "loop/model/scene_model.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace wholehand {

using Eigen::Vector3d;

BodyJoint::BodyJoint(const SceneBody& body)
    : joint_(*body.joint),
      start_(body.pose),
      axis_(body.pose.rotation * body.joint->axis),
      arm_m_(body.pose.rotation * (body.com_m - body.joint->point_m)),
      mass_kg_(body.mass_kg),
      inertia_(body.mass_kg) {
  if (!joint_.isHinge()) return;
  const Vector3d about = start_.rotation.transpose() * axis_;
  inertia_ = about.dot(body.inertia_kg_m2 * about) + mass_kg_ * axis_.cross(arm_m_).squaredNorm();
}

BodyJoint::Twist BodyJoint::twist() const noexcept {
  if (!joint_.isHinge()) return {axis_, Vector3d::Zero()};
  return {axis_.cross(Eigen::AngleAxisd(q_, axis_) * arm_m_), axis_};
}

void BodyJoint::predict(const Vector3d& gravity_m_s2, double step_s) noexcept {
  const double phase = joint_.latch_wave * (q_ - joint_.latch_at);
  // Largest force of the latch.
  const double latch = 0.5 * joint_.latch_energy_j * joint_.latch_wave;
  const double slope = std::max(0.0, latch * joint_.latch_wave * std::cos(phase));
  const double force = mass_kg_ * gravity_m_s2.dot(twist().linear) - latch * std::sin(phase) -
                       joint_.spring_stiffness * (q_ - joint_.spring_rest);
  yield_ = 1.0 / (inertia_ + step_s * joint_.viscous_friction +
                  step_s * step_s * (joint_.spring_stiffness + slope));
  rate_ = yield_ * (inertia_ * rate_ + step_s * force);
  friction_impulse_ = joint_.dry_friction * step_s;
  load_is_held_ = std::abs(force) <= joint_.dry_friction || (q_ <= joint_.least && force < 0.0) ||
                  (q_ >= joint_.most && force > 0.0);
  least_rate_ = (joint_.least - q_) / step_s;
  most_rate_ = (joint_.most - q_) / step_s;
}

void BodyJoint::move(double rate, double step_s) noexcept {
  rate_ = rate;
  q_ = std::clamp(q_ + step_s * rate_, joint_.least, joint_.most);
}

double BodyJoint::energy() const noexcept {
  return 0.5 * inertia_ * rate_ * rate_ + storedEnergy(joint_, q_);
}

}  // namespace wholehand
