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
///
/// Physics at a divisor d: the avatar's steps of dT do not distinguish the frequencies φ + 2πk/d,
/// k = 0 .. d − 1, and each of them reaches the person. The bound is the least b with
///   Σ_k (Re q_k + |q_k|) / (2 (b + Re A₀,k)) <= r₂₂  and  b + Re A₀,k > 0,
/// A₀,k and q_k at φ + 2πk/d, in q  K_pm T/(z − 1) + γB (1 − ζ⁻¹) / (d (z − 1)), ζ = z^d, for the
/// bracket, and r₂₂ with dT and dφ in place of T and φ, φ up to π/d. Exact, too.
/// @param frequencies number of logarithmic sweep points; the worst is then refined between its
///        neighbours
/// @return [N·s/m or N·m·s/rad]
[[nodiscard]] double requiredDamping(const AxisLoop& loop, int frequencies = 4000);

}  // namespace wholehand
