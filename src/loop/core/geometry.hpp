#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <numbers>
#include <type_traits>

namespace wholehand {

/// A vector that can be copied between threads or into a file (Eigen's is not trivially copyable).
struct Vec3 {
  double x = 0.0, y = 0.0, z = 0.0;

  [[nodiscard]] Eigen::Vector3d eigen() const noexcept { return {x, y, z}; }
  [[nodiscard]] static Vec3 from(const Eigen::Vector3d& v) noexcept {
    return {v.x(), v.y(), v.z()};
  }
};

/// A rotation that can be copied between threads or into a file; order x, y, z, w.
struct QuatXyzw {
  double x = 0.0, y = 0.0, z = 0.0, w = 1.0;

  [[nodiscard]] Eigen::Quaterniond eigen() const noexcept { return {w, x, y, z}; }
  [[nodiscard]] static QuatXyzw from(const Eigen::Quaterniond& q) noexcept {
    return {q.x(), q.y(), q.z(), q.w()};
  }
};

/// A rigid transform: p_outer = rotation * p_inner + translation_m.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p_m) const {
    return rotation * p_m + translation_m;
  }
  [[nodiscard]] Pose operator*(const Pose& inner) const {
    return {rotation * inner.rotation, rotation * inner.translation_m + translation_m};
  }
  [[nodiscard]] Pose inverse() const {
    return {rotation.transpose(), -(rotation.transpose() * translation_m)};
  }
};

static_assert(std::is_trivially_copyable_v<Vec3>);
static_assert(std::is_trivially_copyable_v<QuatXyzw>);

inline constexpr double kDeg = std::numbers::pi / 180.0;  ///< one degree [rad]

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
