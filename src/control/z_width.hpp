#pragma once

#include "control/certificate/certificate.hpp"

namespace wholehand {

/// Stiffnesses that an axis can render at one constant adaptive damping.
struct ZWidthPoint {
  double damping = 0.0;  ///< Φ K_dm [N·s/m or N·m·s/rad]
  double rigid = 0.0;    ///< largest K_pm against a rigid stop, nobody attached, by eigenvalues
  double passive = 0.0;  ///< largest K_pm with any passive person and object
  double walled = 0.0;   ///< the same inside the exercise's walls; `passive` without walls
};

/// Z-width of an axis, from no adaptive damping to twice its K_dm (to its own damping where K_dm is
/// 0), with its own γ and its own or the rule's armature. @pre points >= 2
[[nodiscard]] std::vector<ZWidthPoint> zWidth(const AxisCase& c, int points);

}  // namespace wholehand
