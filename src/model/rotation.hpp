#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace wholehand {

/// Rotation about x, then y, then z of the fixed frame [rad]: R = Rz(yaw) Ry(pitch) Rx(roll).
[[nodiscard]] inline Eigen::Matrix3d rotationFromRpy(double roll_rad, double pitch_rad,
                                                     double yaw_rad) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(yaw_rad, Vector3d::UnitZ()) * AngleAxisd(pitch_rad, Vector3d::UnitY()) *
          AngleAxisd(roll_rad, Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace wholehand
