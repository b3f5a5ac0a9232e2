#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/rendering_config.hpp"

#include <cmath>

/// Virtual coupling: one spring and one damper between device and avatar. The spring acts equally
/// on both. The person feels only the share γ of the damper.
namespace wholehand {

/// Critical damping of a unit-mass PD controller under symplectic Euler, Eq. (14) [1/s]: both
/// closed-loop poles at 1 - T sqrt(k_p).
/// @pre kp_per_s2 * period_s^2 <= 1 (no ringing).  Real-time safe.
[[nodiscard]] WHOLEHAND_RT inline double criticalDamping(double kp_per_s2,
                                                         double period_s) noexcept {
  return 2.0 * std::sqrt(kp_per_s2) - kp_per_s2 * period_s;
}

/// Gains of the tick, one value per axis, resolved from the rendering file and the hand's reduced
/// inertia at its reference posture. Immutable while armed.
///
/// The avatar is driven by the spring that the person feels, K_pm. Its damping D follows Eq. (14)
/// in every posture (avatarDamping()).
struct CouplingGains {
  int axes = 0;
  AxisStiffness k_pm;  ///< coupling stiffness K_pm, on person and avatar
  AxisDamping k_dm;
  AxisRatio gamma;        ///< γ: share of D that the person feels
  AxisInertia armature;   ///< reflected inertia added to the avatar
  AxisInertia inertia;    ///< inertia of the avatar at the reference posture, armature included
  AxisTime filter_tau_s;  ///< time constant of the velocity filter
};

/// Armature of an axis for which the file states none: the amount by which its inertia falls short
/// of K_pm / (5e4 s⁻²). The avatar's natural frequency then stays below 36 Hz, which a tick of 1 ms
/// resolves [kg or kg·m²].
[[nodiscard]] double ruleArmature(double k_pm, double inertia) noexcept;

/// The armature stated in the file; without one, ruleArmature().
[[nodiscard]] double armatureOf(const AxisRendering& axis, double inertia) noexcept;

/// M_r with the armature on its diagonal.
[[nodiscard]] AxisMatrix withArmature(const AxisMatrix& reduced_inertia,
                                      const AxisInertia& armature);

/// D of every axis in a posture, Eq. (14) with k_p = K_pm / Mᵢᵢ: 2 √(K_pm Mᵢᵢ) − T K_pm. Both poles
/// of the axis alone then lie at 1 − T √k_p. Pure, real-time safe.
/// @param reduced_inertia M_r, armature included @param period_s of a tick
[[nodiscard]] WHOLEHAND_RT AxisDamping avatarDamping(const AxisMatrix& reduced_inertia,
                                                     const AxisStiffness& k_pm,
                                                     double period_s) noexcept;

/// Inertia of the avatar as felt in free motion, at the reference: K_pm (1 + (1 − γ) k_d τ_f) /
/// k_p, with k_p = K_pm / M and k_d by Eq. (14) [kg or kg·m²].
/// @param period_s of a tick
[[nodiscard]] double feltInertia(const CouplingGains& gains, int axis, double period_s);

/// Resolves the gains. Refuses K_pm / M > 1/T², at which the avatar rings.
/// @param period_s of a tick
[[nodiscard]] Expected<CouplingGains> resolveGains(const RenderingConfig& rendering,
                                                   const AxisMatrix& reduced_inertia_at_reference,
                                                   double period_s);

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
