#pragma once

#include "loop/core/axis_array.hpp"

#include <limits>
#include <string>
#include <vector>

namespace wholehand {

enum class AxisKind { kTranslation, kRotation };
enum class AxisGroup { kBase, kHand };  ///< kBase carries the hand; kHand moves its joints

/// A named axis of a device. SI units; per radian for a rotation.
struct DeviceAxis {
  std::string name;  ///< "x", "finger_flexion", ...
  AxisKind kind = AxisKind::kTranslation;
  AxisGroup group = AxisGroup::kBase;
  double lower = 0.0, upper = 0.0;  ///< range [m or rad]
  double effort_limit = 0.0;        ///< [N or N·m], > 0
  double effort_slew_limit = 0.0;   ///< fastest change of effort [N/s or N·m/s], > 0
  double speed_limit = 0.0;         ///< [m/s or rad/s], > 0; a higher speed stops rendering
  double workspace_margin = 0.0;    ///< a larger excursion beyond the range stops rendering [m or
                                    ///< rad], > 0
  double mass = 0.0;                ///< moving mass [kg or kg·m²], > 0
  double damping = 0.0;             ///< viscous friction [N·s/m or N·m·s/rad], >= 0
  double coulomb = 0.0;             ///< dry friction [N or N·m], >= 0
  double encoder_step = 0.0;        ///< [m or rad], >= 0; 0: ideal
  double lever_arm_m = 0.0;         ///< joint torque divided by tip force; 0: the axis has no tip
  double neutral_effort = 0.0;      ///< carries the axis's own weight [N or N·m]

  /// "N" or "N·m"
  [[nodiscard]] const char* effortUnit() const {
    return kind == AxisKind::kTranslation ? "N" : "N·m";
  }
  /// "m" or "rad"
  [[nodiscard]] const char* positionUnit() const {
    return kind == AxisKind::kTranslation ? "m" : "rad";
  }
};

/// Limits for late ticks and stuck encoders; exceeding one stops rendering. 0: late ticks and stuck
/// encoders are only counted.
struct WatchLimits {
  int late_in_a_row = 0;         ///< a longer run of late ticks stops rendering
  double longest_gap_s = 0.0;    ///< a longer time between two ticks stops rendering
  double stuck_encoder_s = 0.0;  ///< longest standstill of an axis although it should move
};

/// A device: N named axes and the hand's mounting. No code assumes six axes.
struct DeviceModel {
  std::string path;
  std::string name;              ///< "lambda-pride"
  std::vector<DeviceAxis> axes;  ///< 1 .. kMaxAxes
  int output_delay_ticks = 0;    ///< whole samples between write and effect, 0 .. 8
  double drive_lag_s = 0.002;    ///< time constant with which the drives follow an effort, >= 0
  /// Limit of the power that all axes together deliver [W], > 0; +inf: none stated.
  double power_limit_w = std::numeric_limits<double>::infinity();
  WatchLimits watch;
  /// Orientation of a right hand's palm frame in the world when all base rotations are zero
  /// (roll, pitch, yaw about x, y, z; R = Rz Ry Rx). A left hand takes the mirror image in y.
  double mount_roll_rad = 0.0, mount_pitch_rad = 0.0, mount_yaw_rad = 0.0;

  [[nodiscard]] int axisCount() const { return static_cast<int>(axes.size()); }
  /// Index of an axis by name; -1: none.
  [[nodiscard]] int axisIndex(const std::string& axis_name) const;
  /// Effort per axis that holds the device's own weight.
  [[nodiscard]] AxisEffort neutral() const;
};

}  // namespace wholehand
