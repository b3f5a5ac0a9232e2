#pragma once

#include "control/stability.hpp"

namespace wholehand {

/// Least device damping with which one axis is stable with any passive person and any passive world
/// (absolute stability of the two-port of Eq. (2), (3), a stronger property than a stable rigid
/// contact): the largest over all frequencies up to Nyquist of
///   −Re A₀ + (Re q + |q|) / (2 r₂₂),
///   A₀ = T z⁻ⁿ (K_pm + αk + (γB + Φ K_dm + αd) D) / (z − 1),  D = (z − 1)/((τ + T) z − τ),
///   q  = T z⁻ⁿ (K_pm T/(z − 1) + γB z⁻¹) (K_ps + K_ds D) / (z − 1),
///   r₂₂ = (1 − cos φ)/T − T K_ps/2 + K_ds cos φ,  z = e^{jφ}.
/// The bound is exact: with less damping some passive person and object oscillate
/// (docs/certificate.md). `loop.damping` and `loop.mass` have no influence. Infinite where
/// r₂₂ <= 0: the avatar itself is active.
/// @param frequencies number of logarithmic sweep points; the worst is then refined between its
///        neighbours
/// @return [N·s/m or N·m·s/rad]
[[nodiscard]] double requiredDamping(const AxisLoop& loop, int frequencies = 4000);

}  // namespace wholehand
