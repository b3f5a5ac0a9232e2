#pragma once

#include "control/coupling_gains.hpp"
#include "core/axis_array.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// M̃_r of Eq. (2): diagonal, of min((M_r)ᵢᵢ, 6.5 / (M_r⁻¹)ᵢᵢ). The paper's diag(M_r) drives an axis
/// by the mass that it has while the others are held; where axes are strongly coupled (a wrist bent
/// far) what moves is 1 / (M_r⁻¹)ᵢᵢ, up to ten times less, and the loop would ring. Where no axis
/// is six and a half times as heavy held as free, it is the paper's. Pure, real-time safe.
/// @param inverse M_r⁻¹
[[nodiscard]] WHOLEHAND_RT AxisMatrix driveInertia(const AxisMatrix& reduced_inertia,
                                                   const AxisMatrix& inverse) noexcept;

/// Effort on the avatar, Eq. (2) without the bias (the joint torque adds h):
/// f_s = M̃_r (K_ps (q_m − q_s) + K_ds (q̇_m,f − q̇_s)). Pure, real-time safe.
/// @param drive_inertia M̃_r
[[nodiscard]] WHOLEHAND_RT AxisEffort avatarEffort(
    const AxisPosition& q_m, const AxisVelocity& qd_mf, const AxisPosition& q_s,
    const AxisVelocity& qd_s, const AxisMatrix& drive_inertia, const CouplingGains& gains) noexcept;

/// Effort the person feels from the coupling, first part of Eq. (3) with the reciprocal damping:
/// f = K_pm (q_s − q_m) + γ B (q̇_s − q̇_m,f). q_s is the state before the step: after it, the
/// pairing adds −K T of damping. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort couplingEffort(const AxisPosition& q_m,
                                                     const AxisVelocity& qd_mf,
                                                     const AxisPosition& q_s,
                                                     const AxisVelocity& qd_s,
                                                     const CouplingGains& gains) noexcept;

}  // namespace wholehand
