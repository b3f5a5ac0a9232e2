#pragma once

#include "core/body_order.hpp"

#include <cmath>

/// Limits of a game's orders to its bodies that no scene file changes. Real-time safe.
namespace wholehand {

inline constexpr double kFarthest_m = 5.0;  ///< from the origin; farther, a body has left the world
inline constexpr double kMostNormFault = 1e-3;  ///< of a quaternion's norm, from 1
inline constexpr double kMostSpawnSpeed_m_s = 2.0;
inline constexpr double kMostBodyFriction = 2.0;

/// True for a finite pose inside the world whose quaternion is a rotation.
[[nodiscard]] inline bool isBodyPose(const BodyPose& pose) noexcept {
  return pose.position_m.eigen().norm() <= kFarthest_m &&
         std::abs(pose.orientation_xyzw.eigen().norm() - 1.0) <= kMostNormFault;
}

[[nodiscard]] inline bool isBodyOwner(BodyOwner owner) noexcept {
  return owner == BodyOwner::kLoop || owner == BodyOwner::kGame || owner == BodyOwner::kFixed;
}

}  // namespace wholehand
