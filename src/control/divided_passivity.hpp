#pragma once

#include "control/coupled_passivity.hpp"

namespace wholehand {

/// Share of the device's damping that requiredShare() needs at one frequency where physics runs at
/// a divisor. For each image the λ is sought that serves the neediest axis.
/// @param inertia of the posture @param angle_rad per tick, up to π / divisor
/// @param enough no smaller share is of interest: the result is `enough` at least
[[nodiscard]] double dividedShare(const CoupledCase& c, const AxisMatrix& inertia, double angle_rad,
                                  double enough);

}  // namespace wholehand
