#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace wholehand::moteus {

/// Largest number of motors and of axes: WH_MAX_AXES.
inline constexpr std::size_t kMostMotors = 16;
using PerMotor = std::array<double, kMostMotors>;

/// A motor and the joint that it turns: theta = sign (m - offset) / gear_ratio.
struct Motor {
  std::string name;
  int id = 0;                     ///< id of its drive on the bus
  double sign = 1.0;              ///< -1: it turns against its joint
  double gear_ratio = 1.0;        ///< turns of the motor per turn of the joint
  double offset_rad = 0.0;        ///< position of the motor where the joint is at zero
  double max_torque_nm = 0.0;     ///< largest torque that is ever commanded
  double encoder_step_rad = 0.0;  ///< smallest change of position that its drive resolves
};

/// An axis: the joint of its motor, plus shares of axes before it in the series. Example: a thumb's
/// flexion is driven by a cable over the joint of its circumduction, and flexes by 0.4 of the
/// circumduction: couplings = {{circumduction, 0.4}}.
struct MotorAxis {
  struct Coupling {
    std::size_t axis;  ///< an axis before this one
    double ratio;
  };
  std::string name;
  std::size_t motor = 0;
  double lower_rad = 0.0, upper_rad = 0.0;
  double effort_limit_nm = 0.0;
  std::vector<Coupling> couplings;
};

/// Maps between motors and axes: q = A m + b, where A is constant. The power is equal on both
/// sides, tau_q . dq = tau_m . dm, hence tau_m = A^T tau_q. Real-time safe except for the
/// constructor.
class MotorMap {
 public:
  /// @pre every axis has its own motor; couplings name axes before theirs
  MotorMap(std::vector<Motor> motors, std::vector<MotorAxis> axes);

  [[nodiscard]] std::size_t size() const noexcept { return axes_.size(); }
  [[nodiscard]] const std::vector<Motor>& motors() const noexcept { return motors_; }
  [[nodiscard]] const std::vector<MotorAxis>& axes() const noexcept { return axes_; }

  /// Positions of axes from those of motors.
  /// @param motor_rad positions by motor  @return positions by axis [rad]
  [[nodiscard]] PerMotor positions(const PerMotor& motor_rad) const noexcept;
  /// Inverse of positions().
  [[nodiscard]] PerMotor motorPositions(const PerMotor& axis_rad) const noexcept;
  /// Torques of motors from efforts of axes.
  /// @param axis_nm efforts by axis  @return torques by motor [N.m]
  [[nodiscard]] PerMotor torques(const PerMotor& axis_nm) const noexcept;
  /// Inverse of torques(), for measured torques.
  [[nodiscard]] PerMotor axisEfforts(const PerMotor& motor_nm) const noexcept;

  /// Range of the motor of an axis over the whole travel of all axes [rad].
  struct Interval {
    double lower, upper;
  };
  [[nodiscard]] Interval motorTravel(std::size_t axis) const noexcept;
  /// Largest torque of the motor of an axis while no axis exceeds its effort limit [N.m].
  [[nodiscard]] double worstTorque(std::size_t axis) const noexcept;
  /// Smallest change of an axis that its motors together resolve [rad].
  [[nodiscard]] double resolution(std::size_t axis) const noexcept;

 private:
  std::vector<Motor> motors_;
  std::vector<MotorAxis> axes_;
};

}  // namespace wholehand::moteus
