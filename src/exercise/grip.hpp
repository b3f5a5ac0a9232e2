#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "exercise/finger_walls.hpp"
#include "exercise/hand_posture.hpp"

namespace wholehand {

/// Grip force on a body [N]: the sum of the normal forces of palmar contacts, at most five times
/// the weaker of two opposing sides. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double gripForce_n(const TickRecord& record, int body,
                                              const HandPosture& posture) noexcept;

/// Loads on the digits from a body.
struct FeltBody {
  int body = -1;        ///< index in the scene
  AxisEffort wall;      ///< effort of this body's walls on every axis; size 0: none
  SoftTouches touches;  ///< touches of its soft shell
};

/// Squeeze of a body: its force felt at the fingertips [N].
///
///   S = min( Σ_a min(w_a + c_a, f_max,a) / l_a ,  5 · weaker side )
///
/// over the axes with a wall: w_a the wall's effort if the axis has a palmar touch in the soft
/// shell, c_a = -j_aᵀ f of the palmar contacts on the body, f_max,a the device's limit, l_a the
/// lever arm. Sides as in gripForce_n; a digit in the soft shell counts with w_a / l_a along its
/// normal. The palm adds no squeeze; the digits press against it. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double feltSqueeze_n(const TickRecord& record, const FeltBody& felt,
                                                const HandPosture& posture,
                                                const FingerWallConfig& walls,
                                                const AxisEffort& effort_limit) noexcept;

}  // namespace wholehand
