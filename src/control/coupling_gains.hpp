#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "core/real_time.hpp"
#include "model/rendering_config.hpp"

namespace wholehand {

/// The gains of the tick, one value per axis, resolved from the rendering file and the hand's
/// reduced inertia at its reference posture. Plain numbers, immutable while armed.
///
/// The avatar hangs on the very spring that the person feels, K_pm: what is felt is what acts.
/// Its damping D follows Eq. (14) in every posture (avatarDamping()).
struct CouplingGains {
  int axes = 0;
  AxisRatio k_pm;          ///< of the coupling, felt and acting [N/m or N·m/rad]
  AxisRatio k_dm;          ///< [N·s/m or N·m·s/rad]
  AxisRatio gamma;         ///< γ: share of D that the person feels [1]
  AxisRatio armature;      ///< reflected inertia added to the avatar [kg or kg·m²]
  AxisRatio inertia;       ///< of the avatar at the hand's reference, armature included
  AxisRatio filter_tau_s;  ///< time constant of the velocity filter
};

/// The armature of an axis where a file states none: what it lacks to K_pm / (5e4 s⁻²), so that the
/// avatar's own frequency stays below 36 Hz and a tick of 1 ms resolves it [kg or kg·m²].
[[nodiscard]] double ruleArmature(double k_pm, double inertia) noexcept;

/// As stated, or by the rule.
[[nodiscard]] double armatureOf(const AxisRendering& axis, double inertia) noexcept;

/// M_r with armature on its diagonal.
[[nodiscard]] AxisMatrix withArmature(const AxisMatrix& reduced_inertia, const AxisRatio& armature);

/// D of every axis in a posture, Eq. (14) with k_p = K_pm / Mᵢᵢ: 2 √(K_pm Mᵢᵢ) − T K_pm, at which
/// both poles of the axis by itself lie at 1 − T √k_p. Pure, real-time safe.
/// @param reduced_inertia M_r, armature included
[[nodiscard]] WHOLEHAND_RT AxisRatio avatarDamping(const AxisMatrix& reduced_inertia,
                                                   const AxisRatio& k_pm, double period_s) noexcept;

/// What the avatar weighs in free motion, at the reference: K_pm (1 + (1 − γ) k_d τ_f) / k_p, with
/// k_p = K_pm / M and k_d by Eq. (14) [kg or kg·m²].
[[nodiscard]] double feltInertia(const CouplingGains& gains, int axis, double period_s);

/// Resolves the gains. Refuses K_pm / M > 1/T², at which the avatar rings.
[[nodiscard]] Expected<CouplingGains> resolveGains(const RenderingConfig& rendering,
                                                   const AxisMatrix& reduced_inertia_at_reference,
                                                   double period_s);

}  // namespace wholehand
