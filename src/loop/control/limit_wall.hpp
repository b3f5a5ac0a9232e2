#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"

namespace wholehand {

/// One-sided walls at the ends of a person's range. Each is a spring over the last band of the
/// range, with a largest effort:
///   f = −min(k p, f̂), p = max(0, q − w) at the upper end; mirrored at the lower one.
/// Where the hand is already in a band or beyond it, the wall begins at the hand, w = q, and
/// follows it home, half a band behind: it moves only while nothing presses it, and never outward.
/// So a hand that does not move feels nothing, and the wall returns no more work than it received.
struct LimitWallConfig {
  int axes = 0;
  AxisPosition lower, upper;  ///< the person's range; ∓inf: no limit there
  AxisPosition band;          ///< width of the wall [m or rad], > 0
  AxisStiffness stiffness;    ///< k; 0: no walls on the axis
  AxisEffort most;            ///< f̂ [N or N·m]
};

/// w of both ends; ∓inf without a limit.
struct LimitWallState {
  AxisPosition lower, upper;
};

/// Begins the walls where the hand is: at arming, and at every change of a limit. Pure, real-time
/// safe, as all below.
[[nodiscard]] WHOLEHAND_RT LimitWallState placeLimitWalls(const LimitWallConfig& config,
                                                          const AxisPosition& q) noexcept;
/// Moves the walls home after the hand.
[[nodiscard]] WHOLEHAND_RT LimitWallState followHome(const LimitWallState& state,
                                                     const LimitWallConfig& config,
                                                     const AxisPosition& q) noexcept;
/// Effort of the walls on the hand, and the energy that they store, of one axis.
struct LimitPush {
  double effort = 0.0;    ///< [N or N·m]
  double stored_j = 0.0;  ///< work that the hand gets back on its way home
};
[[nodiscard]] WHOLEHAND_RT LimitPush pushOfLimit(const LimitWallState& state,
                                                 const LimitWallConfig& config, int axis,
                                                 double q) noexcept;

}  // namespace wholehand
