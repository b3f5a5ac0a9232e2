#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "exercise/finger_walls.hpp"
#include "exercise/hand_posture.hpp"

namespace wholehand {

/// What of the contacts on a body is a grip [N]: normal forces of palmar contacts that oppose each
/// other. Their sum, at most five times what the weaker of two opposite sides bears. Real-time
/// safe.
[[nodiscard]] WHOLEHAND_RT double gripForce_n(const TickRecord& record, int body,
                                              const HandPosture& posture) noexcept;

/// What the digits feel of a body.
struct FeltBody {
  int body = -1;        ///< index in the scene
  AxisEffort wall;      ///< the exercise's effort on every axis, of this body's walls; size 0: none
  SoftTouches touches;  ///< of its soft side
};

/// The squeeze of a body: what is felt of it at the fingertips [N].
///
///   S = min( Σ_a min(w_a + c_a, f_max,a) / l_a ,  5 · weaker side )
///
/// over the axes with a wall: w_a the wall's effort where the axis has a palmar touch in the soft
/// side, c_a = -j_aᵀ f of the palmar contacts on the body, f_max,a the device's limit, l_a the
/// lever arm. Sides as in gripForce_n, where a digit in the soft side bears w_a / l_a along its
/// normal. The palm feels no squeeze; it is what the digits press against. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double feltSqueeze_n(const TickRecord& record, const FeltBody& felt,
                                                const HandPosture& posture,
                                                const FingerWallConfig& walls,
                                                const AxisEffort& effort_limit) noexcept;

}  // namespace wholehand
