#pragma once

#include "core/expected.hpp"
#include "core/tick_record.hpp"
#include "core/world_query.hpp"

#include <cmath>
#include <string>

/// Checks of scene bodies for all engines.
namespace wholehand {

/// Real-time safe.
[[nodiscard]] inline bool allFinite(const BodyState& body) noexcept {
  return body.position_m.eigen().allFinite() && body.velocity_m_s.eigen().allFinite() &&
         body.angular_velocity_rad_s.eigen().allFinite() &&
         body.orientation_xyzw.eigen().coeffs().allFinite();
}

/// True when a body can be placed there. Real-time safe.
[[nodiscard]] inline bool isPose(const BodyPlacement& placement) noexcept {
  return placement.position_m.eigen().allFinite() && placement.velocity_m_s.eigen().allFinite() &&
         std::abs(placement.orientation_xyzw.eigen().squaredNorm() - 1.0) < 0.1;
}

/// Error for placing a hand while a body's state is not finite.
[[nodiscard]] inline Diagnostic nonFiniteBodyError(const std::string& scene_path,
                                                   const std::string& body) {
  return {scene_path, 0, "bodies." + body, "", "is nowhere after a fault", "build the scene anew"};
}

}  // namespace wholehand
