#pragma once

#include "control/certificate/certificate.hpp"
#include "control/stability.hpp"

#include <cstddef>
#include <vector>

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

/// Share of the device's damping that the whole hand needs to be stable with any passive person and
/// any passive world, *both of which may link its axes*. Mass, damping and stiffness of person and
/// object are full matrices: a grasp links fingers and thumb.
///
/// With x the device's velocities, y the avatar's, W and Z the impedances of person and world
/// (Hermitian parts >= 0), the loop sustains an oscillation at the angle φ where
///   (b + A₀ + W) x = Q_m y,   (R + Z) y = Q_s x,  z = e^{jφ},
///   A₀  = T z⁻ⁿ (K_pm + αk + (γD + Φ K_dm + αd) d) / (z − 1),  d = (z − 1)/((τ + T) z − τ),
///   Q_m = z⁻ⁿ (K_pm T/(z − 1) + γD z⁻¹),   Q_s = (K_pm + D d) T/(z − 1),   all diagonal,
///   Re R = M_r (1 − cos φ)/T − T K_pm/2 + D cos φ,  M_r with all its couplings.
/// No passive W and Z solve it exactly when, for one λ > 0, *the same for all axes*,
///   b + Re A₀ − E (4 λ Re R)⁻¹ Eᴴ,   E = Q_m + λ Q_sᴴ,   is positive definite
/// (S-procedure for two Hermitian forms, lossless; docs/certificate.md). For one axis the best λ
/// gives b_min of requiredDamping(). As φ → 0, Q_m/Q_sᴴ is the ratio of the felt to the acting
/// spring. If the axes differed in it, no damping would suffice.
///
/// That λ may differ from one frequency to the next, so the condition is of linear, time-invariant
/// persons and objects, and of a constant Φ. With λ = 1 at every frequency it is an inequality of
/// energies over time (Parseval), which any passive person and object obey, nonlinear and
/// time-varying ones, too. A Φ that changes with every tick is w = Φ u, u = g ẋ the filtered
/// velocity; w (u − w) >= 0, weighed by p K_dm, joins the inequality:
///   b + Re A₀(Φ = 0) − E (4 Re R)⁻¹ Eᴴ − K_dm |zⁿ − p g|²/4p  is positive definite for one p > 0,
///   g = T/((τ + T) z − τ).
/// This is sufficient, not necessary (docs/certificate.md).
struct RequiredShare {
  double share = 0.0;         ///< of the device's damping; < 1 passes; +inf: no damping suffices
  double frequency_hz = 0.0;  ///< frequency of the largest share
  double lambda = 1.0;        ///< λ at that frequency
  std::size_t posture = 0;    ///< posture of the largest share, from 0
};

/// Input of the coupled criterion.
struct CoupledCase {
  std::vector<AxisCase> axes;        ///< with their walls
  std::vector<AxisMatrix> inertias;  ///< of the sampled postures, armature included
  int delay_ticks = 0;
  double period_s = 1e-3;
  Persons persons = Persons::kLinear;
};
[[nodiscard]] CoupledCase coupledCase(const CertificateInput& input);

/// The largest share over postures, frequencies, every Φ, and every constant α of the exercise's
/// walls.
[[nodiscard]] RequiredShare requiredShare(const CoupledCase& c);

}  // namespace wholehand
