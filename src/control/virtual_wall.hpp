#pragma once

#include "core/real_time.hpp"

namespace wholehand {

/// A wall on one axis. Stiffness in [N/m or N·m/rad], damping in [N·s/m or N·m·s/rad].
struct VirtualWall {
  double position = 0.0;    ///< θ_wall [m or rad]
  double closing = 1.0;     ///< s: +1 where closing raises the coordinate, -1 where it lowers it
  double stiffness = 0.0;   ///< k
  double damping = 0.0;     ///< d
  double effort_cap = 0.0;  ///< upper limit of max(0, k p + d ṗ) [N or N·m]
};

/// Eq. (15) with corrected signs (docs/equations.md): with p = s (θ − θ_wall),
///   f_e = −s α min(cap, max(0, k p + d ṗ_f)) where p > 0, else 0.
/// The wall never pulls: s f_e <= 0 for any input. Non-finite input gives 0.
/// @param position device coordinate θ @param velocity its filtered velocity
/// @param alpha of the transition, 0 .. 1. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT double wallEffort(const VirtualWall& wall, double position,
                                             double velocity, double alpha) noexcept;

}  // namespace wholehand
