#pragma once

#include "control/coupling_gains.hpp"
#include "core/axis_array.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// Effort on the avatar, Eq. (2) without the bias (the joint torque adds h):
/// f_s = M̃_r (K_ps (q_m − q_s) + K_ds (q̇_m,f − q̇_s)), M̃_r = diag(M_r). Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort avatarEffort(const AxisPosition& q_m,
                                                   const AxisVelocity& qd_mf,
                                                   const AxisPosition& q_s,
                                                   const AxisVelocity& qd_s,
                                                   const AxisMatrix& reduced_inertia,
                                                   const CouplingGains& gains) noexcept;

/// Effort the person feels from the coupling, first part of Eq. (3) with the reciprocal damping:
/// f = K_pm (q_s − q_m) + γ B (q̇_s − q̇_m,f). q_s is the state before the step: after it, the
/// pairing adds −K T of damping. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort couplingEffort(const AxisPosition& q_m,
                                                     const AxisVelocity& qd_mf,
                                                     const AxisPosition& q_s,
                                                     const AxisVelocity& qd_s,
                                                     const CouplingGains& gains) noexcept;

}  // namespace wholehand
