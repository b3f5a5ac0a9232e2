#pragma once

#include "control/coupling_gains.hpp"
#include "core/axis_array.hpp"
#include "core/real_time.hpp"

/// Virtual coupling: one spring and one damper between device and avatar. The spring acts equally
/// on both. The person feels the share γ of the damper.
namespace wholehand {

/// State of the velocity estimator.
struct VelocityState {
  AxisPosition previous;
  AxisVelocity filtered;  ///< q̇_m,f
  bool started = false;
};

/// Backward difference over the elapsed time, then a first-order low-pass discretised by backward
/// Euler (paper §II-C): v_f ← (τ v_f + Δq) / (τ + kT). The first call yields zero velocity.
/// @param elapsed_periods 1 + skipped periods. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT VelocityState estimateVelocity(const VelocityState& state,
                                                          const AxisPosition& q_m,
                                                          const CouplingGains& gains,
                                                          int elapsed_periods,
                                                          double period_s) noexcept;

/// Effort on the avatar, Eq. (2) without the bias (the joint torque adds h), with the same spring
/// as the person feels: f_s = K_pm (q_m − q_s) + D (q̇_m,f − q̇_s). Pure, real-time safe.
/// @param avatar_damping D of avatarDamping() for the present posture
[[nodiscard]] WHOLEHAND_RT AxisEffort avatarEffort(const AxisPosition& q_m,
                                                   const AxisVelocity& qd_mf,
                                                   const AxisPosition& q_s,
                                                   const AxisVelocity& qd_s,
                                                   const AxisDamping& avatar_damping,
                                                   const CouplingGains& gains) noexcept;

/// Effort of the coupling on the person, first part of Eq. (3) with the reciprocal damping: f =
/// K_pm (q_s − q_m) + γ D (q̇_s − q̇_m,f). q_s is the state before the step; the state after it
/// would add −K T of damping. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort couplingEffort(const AxisPosition& q_m,
                                                     const AxisVelocity& qd_mf,
                                                     const AxisPosition& q_s,
                                                     const AxisVelocity& qd_s,
                                                     const AxisDamping& avatar_damping,
                                                     const CouplingGains& gains) noexcept;

}  // namespace wholehand
