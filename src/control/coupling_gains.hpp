#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "model/rendering_config.hpp"

namespace wholehand {

/// The gains of the tick, one value per axis, resolved from the rendering file and the hand's
/// reduced inertia at its reference posture. Plain numbers, immutable while armed.
struct CouplingGains {
  int axes = 0;
  AxisRatio k_pm;              ///< [N/m or N·m/rad]
  AxisRatio k_dm;              ///< [N·s/m or N·m·s/rad]
  AxisRatio gamma;             ///< γ [1]
  AxisRatio k_ps_per_s2;       ///< [1/s²]
  AxisRatio k_ds_per_s;        ///< Eq. (14) [1/s]
  AxisRatio relative_damping;  ///< B = K_pm K_ds / K_ps [N·s/m or N·m·s/rad]
  AxisRatio filter_tau_s;      ///< time constant of the velocity filter
  AxisRatio contact_scale;  ///< σ = K_pm / (K_ps M̃_ii): felt over simulated force; 1 is the truth
};

/// The rule for K_ps when a file gives none: min(K_pm / M̃_ii, 5e4 s⁻²) [1/s²], so that σ = 1 until
/// the avatar is so light that the velocity filter's lag, not its gain, rules the felt mass.
[[nodiscard]] double ruleStiffness(double k_pm, double inertia) noexcept;

/// Resolves the gains: K_ps from the file, or by the rule min(K_pm / M̃_ii(q_ref), 5e4 s⁻²); K_ds by
/// Eq. (14). Refuses K_ps > 1/T² (rings).
[[nodiscard]] Expected<CouplingGains> resolveGains(const RenderingConfig& rendering,
                                                   const AxisMatrix& reduced_inertia_at_reference,
                                                   double period_s);

}  // namespace wholehand
