#include "motor_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand::moteus {

MotorMap::MotorMap(std::vector<Motor> motors, std::vector<MotorAxis> axes)
    : motors_(std::move(motors)), axes_(std::move(axes)) {}

// For joint angles theta by axis, q = theta + C q. C holds the couplings and is strictly lower
// triangular, so the equation is solved row by row, without an inverse.
PerMotor MotorMap::positions(const PerMotor& motor_rad) const noexcept {
  PerMotor q{};
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const MotorAxis& axis = axes_[a];
    const Motor& motor = motors_[axis.motor];
    q[a] = motor.sign * (motor_rad[axis.motor] - motor.offset_rad) / motor.gear_ratio;
    for (const auto& c : axis.couplings) q[a] += c.ratio * q[c.axis];
  }
  return q;
}

PerMotor MotorMap::motorPositions(const PerMotor& axis_rad) const noexcept {
  PerMotor m{};
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const MotorAxis& axis = axes_[a];
    const Motor& motor = motors_[axis.motor];
    double theta = axis_rad[a];
    for (const auto& c : axis.couplings) theta -= c.ratio * axis_rad[c.axis];
    m[axis.motor] = motor.offset_rad + motor.sign * motor.gear_ratio * theta;
  }
  return m;
}

// Solves (I - C)^T tau_theta = tau_q from the last axis to the first.
PerMotor MotorMap::torques(const PerMotor& axis_nm) const noexcept {
  PerMotor joint = axis_nm;
  PerMotor m{};
  for (std::size_t a = axes_.size(); a-- > 0;) {
    const MotorAxis& axis = axes_[a];
    const Motor& motor = motors_[axis.motor];
    for (const auto& c : axis.couplings) joint[c.axis] += c.ratio * joint[a];
    m[axis.motor] = motor.sign * joint[a] / motor.gear_ratio;
  }
  return m;
}

PerMotor MotorMap::axisEfforts(const PerMotor& motor_nm) const noexcept {
  PerMotor joint{};
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const Motor& motor = motors_[axes_[a].motor];
    joint[a] = motor.sign * motor.gear_ratio * motor_nm[axes_[a].motor];
  }
  PerMotor q = joint;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    for (const auto& c : axes_[a].couplings) q[c.axis] -= c.ratio * joint[a];
  }
  return q;
}

MotorMap::Interval MotorMap::motorTravel(std::size_t axis) const noexcept {
  const MotorAxis& at = axes_[axis];
  const Motor& motor = motors_[at.motor];
  double lower = at.lower_rad, upper = at.upper_rad;
  for (const auto& c : at.couplings) {
    const double one = c.ratio * axes_[c.axis].lower_rad, other = c.ratio * axes_[c.axis].upper_rad;
    lower -= std::max(one, other);
    upper -= std::min(one, other);
  }
  const double one = motor.offset_rad + motor.sign * motor.gear_ratio * lower;
  const double other = motor.offset_rad + motor.sign * motor.gear_ratio * upper;
  return {std::min(one, other), std::max(one, other)};
}

// Torques are linear in efforts, so the worst case is the sum over the limits of all axes.
double MotorMap::worstTorque(std::size_t axis) const noexcept {
  double worst = 0.0;
  for (std::size_t b = 0; b < axes_.size(); ++b) {
    PerMotor effort{};
    effort[b] = axes_[b].effort_limit_nm;
    worst += std::abs(torques(effort)[axes_[axis].motor]);
  }
  return worst;
}

// No step of the axis is larger than the sum of the steps of all motors that move it.
double MotorMap::resolution(std::size_t axis) const noexcept {
  double sum = 0.0;
  const PerMotor zero = positions({});
  for (std::size_t m = 0; m < motors_.size(); ++m) {
    PerMotor step{};
    step[m] = motors_[m].encoder_step_rad;
    sum += std::abs(positions(step)[axis] - zero[axis]);
  }
  return sum;
}

}  // namespace wholehand::moteus
