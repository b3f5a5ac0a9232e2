#pragma once

#include "core/geometry.hpp"
#include "core/real_time.hpp"

#include <Eigen/Core>

#include <cmath>
#include <limits>

namespace wholehand {

/// A joint of a body to the world. Its coordinate q is 0 in the body's initial pose and counts
/// along or about the axis, right-handed. Units of a hinge, of a slide.
struct SceneJoint {
  enum class Type { kHinge, kSlide };
  Type type = Type::kHinge;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();          ///< unit, body frame
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();        ///< of a hinge's axis, body frame
  double least = -std::numeric_limits<double>::infinity();  ///< ends [rad; m]; least <= 0 <= most
  double most = std::numeric_limits<double>::infinity();
  double dry_friction = 0.0;      ///< [N·m; N]
  double viscous_friction = 0.0;  ///< [N·m·s/rad; N·s/m]
  double spring_stiffness = 0.0;  ///< [N·m/rad; N/m]
  double spring_rest = 0.0;       ///< q without spring force [rad; m]
  double latch_energy_j = 0.0;    ///< U₀, between the bottom of a detent and the top beside it
  double latch_wave = 0.0;        ///< n, waves of the latch's potential in 2π of q [1/rad; 1/m]
  double latch_at = 0.0;          ///< q of a detent [rad; m]

  [[nodiscard]] bool isHinge() const { return type == Type::kHinge; }
  /// A hinge without ends.
  [[nodiscard]] bool turnsFreely() const {
    return isHinge() && most - least > std::numeric_limits<double>::max();
  }
};

/// Pose of a body frame at q. @param start its pose at q = 0. Real-time safe.
[[nodiscard]] WHOLEHAND_RT Pose poseOn(const SceneJoint& joint, const Pose& start,
                                       double q) noexcept;
/// The q, within the joint's range, at which the body frame is nearest to a pose; of a hinge
/// without range in (-π, π]. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double positionOn(const SceneJoint& joint, const Pose& start,
                                             const Pose& pose) noexcept;

/// Energy that spring and latch of a joint store at q [J]; 0 at the spring's rest and in a detent.
/// Real-time safe.
[[nodiscard]] WHOLEHAND_RT inline double storedEnergy(const SceneJoint& joint, double q) noexcept {
  const double stretch = q - joint.spring_rest;
  return 0.5 * joint.spring_stiffness * stretch * stretch +
         0.5 * joint.latch_energy_j * (1.0 - std::cos(joint.latch_wave * (q - joint.latch_at)));
}

}  // namespace wholehand
