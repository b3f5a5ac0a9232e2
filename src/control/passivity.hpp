#pragma once

#include "control/stability.hpp"

namespace wholehand {

/// The least device damping with which one axis stays stable whatever passive person holds it and
/// whatever passive world the hand meets (absolute stability of the two-port of Eq. (2), (3), a
/// stronger claim than a stable rigid contact): the largest over all frequencies up to Nyquist of
///   −Re A₀ + (Re q + |q|) / (2 r₂₂),
///   A₀ = T z⁻ⁿ (K_pm + αk + (γB + Φ K_dm + αd) D) / (z − 1),  D = (z − 1)/((τ + T) z − τ),
///   q  = T z⁻ⁿ (K_pm T/(z − 1) + γB z⁻¹) (K_ps + K_ds D) / (z − 1),
///   r₂₂ = (1 − cos φ)/T − T K_ps/2 + K_ds cos φ,  z = e^{jφ}.
/// It is exact: with less, some passive person and object do swing (docs/certificate.md).
/// `loop.damping` and `loop.mass` play no part. Infinite where r₂₂ <= 0: the avatar itself is
/// active.
/// @param frequencies how many are swept, spaced evenly on the logarithm, before the worst is
///        looked for between its neighbours; fewer for a first look
/// @return [N·s/m or N·m·s/rad]
[[nodiscard]] double requiredDamping(const AxisLoop& loop, int frequencies = 4000);

}  // namespace wholehand
