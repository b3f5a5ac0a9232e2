#include "physics/body_joint.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace wholehand {

using Eigen::Vector3d;

BodyJoint::BodyJoint(const SceneBody& body)
    : joint_(*body.joint),
      start_(body.pose),
      axis_((body.pose.rotation * body.joint->axis).normalized()),
      point_m_(body.pose * body.joint->point_m),
      arm_m_(body.pose * body.com_m - point_m_),
      mass_kg_(body.mass_kg),
      inertia_(body.mass_kg) {
  if (!joint_.isHinge()) return;
  const Vector3d about = start_.rotation.transpose() * axis_;
  inertia_ = about.dot(body.inertia_kg_m2 * about) + mass_kg_ * axis_.cross(arm_m_).squaredNorm();
}

Pose BodyJoint::pose() const noexcept {
  if (!joint_.isHinge()) return {start_.rotation, start_.translation_m + q_ * axis_};
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(q_, axis_).toRotationMatrix();
  return {turn * start_.rotation, point_m_ + turn * (start_.translation_m - point_m_)};
}

BodyJoint::Twist BodyJoint::twist() const noexcept {
  if (!joint_.isHinge()) return {axis_, Vector3d::Zero()};
  return {axis_.cross(Eigen::AngleAxisd(q_, axis_) * arm_m_), axis_};
}

double BodyJoint::nearest(const Pose& pose) const noexcept {
  double q = axis_.dot(pose.translation_m - start_.translation_m);
  if (joint_.isHinge()) {
    const Eigen::Quaterniond turn(
        Eigen::Matrix3d(pose.rotation * start_.rotation.transpose()));
    q = 2.0 * std::atan2(axis_.dot(turn.vec()), turn.w());
    // A range need not lie about 0: q and q ± 2π are one pose.
    constexpr double kTurn = 6.283185307179586;
    if (q > joint_.most && q - kTurn >= joint_.least) q -= kTurn;
    if (q < joint_.least && q + kTurn <= joint_.most) q += kTurn;
  }
  return std::clamp(q, joint_.least, joint_.most);
}

void BodyJoint::predict(const Vector3d& gravity_m_s2, double step_s) noexcept {
  const double phase = joint_.latch_wave * (q_ - joint_.latch_at);
  const double latch = 0.5 * joint_.latch_energy_j * joint_.latch_wave;  // its largest force
  const double slope = std::max(0.0, latch * joint_.latch_wave * std::cos(phase));
  const double force = mass_kg_ * gravity_m_s2.dot(twist().linear) - latch * std::sin(phase) -
                       joint_.spring_stiffness * (q_ - joint_.spring_rest);
  yield_ = 1.0 / (inertia_ + step_s * joint_.viscous_friction +
                  step_s * step_s * (joint_.spring_stiffness + slope));
  rate_ = yield_ * (inertia_ * rate_ + step_s * force);
  friction_impulse_ = joint_.dry_friction * step_s;
  least_rate_ = (joint_.least - q_) / step_s;
  most_rate_ = (joint_.most - q_) / step_s;
}

void BodyJoint::move(double rate, double step_s) noexcept {
  rate_ = rate;
  q_ = std::clamp(q_ + step_s * rate_, joint_.least, joint_.most);
}

double BodyJoint::energy() const noexcept {
  const double stretch = q_ - joint_.spring_rest;
  return 0.5 * (inertia_ * rate_ * rate_ + joint_.spring_stiffness * stretch * stretch) +
         0.5 * joint_.latch_energy_j *
             (1.0 - std::cos(joint_.latch_wave * (q_ - joint_.latch_at)));
}

}  // namespace wholehand
