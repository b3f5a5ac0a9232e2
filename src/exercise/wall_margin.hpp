#pragma once

#include "control/stability.hpp"

namespace wholehand {

/// The axis's damping over the least with which it is stable for any passive person and object
/// (control/passivity.hpp) while the finger is in a wall: the worst over α and Φ = 0, ¼ .. 1.
/// 0 where the loop with a free or a blocked avatar is unstable by itself. Passes from 1 on.
/// @param loop of the axis, its phi_k_dm at Φ = 1 @param stiffness k @param damping d of the wall
[[nodiscard]] double wallMargin(const AxisLoop& loop, double stiffness, double damping);

}  // namespace wholehand
