#pragma once

#include "control/certificate.hpp"

namespace wholehand {

/// The stiffnesses an axis can render at one constant adaptive damping.
struct ZWidthPoint {
  double damping = 0.0;  ///< Φ K_dm [N·s/m or N·m·s/rad]
  double rigid = 0.0;    ///< largest K_pm against a rigid stop, nobody attached, by eigenvalues
  double passive = 0.0;  ///< largest K_pm with any passive person and any passive object
  double walled = 0.0;   ///< the same in the exercise's walls; `passive` where it has none
};

/// The Z-width of an axis, from no adaptive damping to twice its K_dm (its own damping where K_dm
/// is 0), with its own γ and K_ps, or the rule. @pre points >= 2
[[nodiscard]] std::vector<ZWidthPoint> zWidth(const AxisCase& c, int points);

}  // namespace wholehand
