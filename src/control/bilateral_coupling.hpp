#pragma once

#include "control/coupling_gains.hpp"
#include "core/axis_array.hpp"
#include "core/real_time.hpp"

/// One spring and one damper between device and avatar. The spring acts alike on both; of the
/// damper the person feels the share γ.
namespace wholehand {

/// Effort on the avatar, Eq. (2) without the bias (the joint torque adds h), with the spring that
/// the person feels: f_s = K_pm (q_m − q_s) + D (q̇_m,f − q̇_s). Pure, real-time safe.
/// @param avatar_damping D, as avatarDamping() gives it for the present posture
[[nodiscard]] WHOLEHAND_RT AxisEffort avatarEffort(
    const AxisPosition& q_m, const AxisVelocity& qd_mf, const AxisPosition& q_s,
    const AxisVelocity& qd_s, const AxisRatio& avatar_damping, const CouplingGains& gains) noexcept;

/// Effort the person feels from the coupling, first part of Eq. (3) with the reciprocal damping:
/// f = K_pm (q_s − q_m) + γ D (q̇_s − q̇_m,f). q_s is the state before the step: after it, the
/// pairing adds −K T of damping. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort couplingEffort(
    const AxisPosition& q_m, const AxisVelocity& qd_mf, const AxisPosition& q_s,
    const AxisVelocity& qd_s, const AxisRatio& avatar_damping, const CouplingGains& gains) noexcept;

}  // namespace wholehand
