#pragma once

#include "loop/core/expected.hpp"

#include <optional>
#include <string>

namespace wholehand::force_dimension {

/// The gripper as an axis of the hand: q = (open - s angle) flexion / (open - closed), where s is
/// -1 for a left-hand gripper, whose angle is negative.
struct GripperSettings {
  std::string axis;         ///< name in the device file: finger_flexion
  double open_rad = 0.0;    ///< opening angle where the fingers are straight
  double closed_rad = 0.0;  ///< opening angle where they are bent by flexion_rad
  double flexion_rad = 0.0;
  double lever_m = 0.0;  ///< distance from the gripper's pivot to the point of its force
  double force_limit_n = 0.0;
  double step_rad = 0.0;  ///< smallest change of the opening angle
};

/// Settings file of the driver.
struct ForceSettings {
  std::string path;
  double delay_s = 0.0;     ///< from a write to its effect
  double watchdog_s = 0.0;  ///< timeout of the device's watchdog, from its maker
  double yaw_rad = 0.0;     ///< rotation of the device's frame about our z axis
  double force_limit_n = 0.0;
  double half_travel_m = 0.0;  ///< half travel of each translation
  double step_m = 0.0;
  std::optional<GripperSettings> gripper;
};

/// Reads the file; refuses unknown keys, and reports all faults at once. Not for the tick.
[[nodiscard]] Expected<ForceSettings> loadForceSettings(const std::string& path);

}  // namespace wholehand::force_dimension
