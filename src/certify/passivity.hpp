#pragma once

#include "certify/certificate.hpp"
#include "certify/stability.hpp"

#include <cstddef>
#include <vector>

namespace wholehand {

/// Least device damping b_min with which one axis is stable with any passive person and any passive
/// object: absolute stability of the two-port of Eq. (2), (3), a stronger property than a stable
/// rigid contact. The criterion is the maximum over all φ = ωT up to Nyquist of
///   −Re A₀ + (Re q + |q|) / (2 r₂₂),
///   A₀ = T z⁻ⁿ (K_pm + αk + (γB + Φ K_dm + αd) u) / (z − 1),  u = (z − 1)/((τ + T) z − τ),
///   q  = T z⁻ⁿ (K_pm T/(z − 1) + γB z⁻¹) (K_ps + K_ds u) / (z − 1),
///   r₂₂ = (1 − cos φ)/T − T K_ps/2 + K_ds cos φ,  z = e^{jφ},
/// plus `loop.wall_late`. `loop.damping` and `loop.mass` have no influence. The result is infinite
/// where r₂₂ <= 0: the avatar itself is active.
///
/// Conditions: person and object are linear and time-invariant, Φ and α are constant. The bound is
/// then exact: with less damping some passive person and object oscillate. Proof:
/// docs/certificate.md#proofs. tests/certify/worst_termination.hpp builds this person and object.
/// @pre loop.period_s > 0, loop.k_ps_per_s2 > 0, frequencies >= 1
/// @param frequencies number of logarithmic sweep points; the maximum is then refined between the
///        neighbours of the worst point
/// @return b_min [N·s/m or N·m·s/rad]
[[nodiscard]] double requiredDamping(const AxisLoop& loop, int frequencies = 4000);

/// Share of the device's damping that the whole hand needs to be stable with any passive person and
/// any passive object, *both of which may link its axes*: their masses, dampings and stiffnesses
/// are full matrices. The criterion is that, at every angle φ = ωT, for one λ > 0 *that is the same
/// for all axes*,
///   b + Re A₀ − E (4 λ Re R)⁻¹ Eᴴ is positive definite,  E = Q_m + λ Q_sᴴ,  z = e^{jφ},
///   A₀  = T z⁻ⁿ (K_pm + αk + (γB + Φ K_dm + αd) u) / (z − 1),  u = (z − 1)/((τ + T) z − τ),
///   Q_m = z⁻ⁿ (K_pm T/(z − 1) + γB z⁻¹),   Q_s = (K_pm + B u) T/(z − 1),   all diagonal,
///   Re R = M_r (1 − cos φ)/T − T K_pm/2 + B cos φ,  M_r with all its couplings.
///
/// Conditions of Persons::kLinear: person and object are linear and time-invariant, Φ and α are
/// constant. The criterion is then exact. For one axis it gives the b_min of requiredDamping().
///
/// Persons::kAny covers any passive person and object, also nonlinear and time-varying ones, and a
/// Φ that changes with every tick. It requires λ = 1 and one p > 0 for all frequencies and
/// postures:
///   b + Re A₀(Φ = 0) − E (4 Re R)⁻¹ Eᴴ − K_dm |zⁿ − p g|²/4p is positive definite,
///   g = T/((τ + T) z − τ).
/// This is sufficient, not necessary. Proofs: docs/certificate.md#proofs.
struct RequiredShare {
  double share = 0.0;  ///< share of the device's damping; < 1 passes; +inf: no damping suffices
  double frequency_hz = 0.0;  ///< frequency of the largest share
  double lambda = 1.0;        ///< λ at that frequency
  std::size_t posture = 0;    ///< posture of the largest share, from 0
};

/// Input of the coupled criterion.
struct CoupledCase {
  std::vector<AxisCase> axes;        ///< with their walls
  std::vector<AxisMatrix> inertias;  ///< at the reference, then in sampled postures; with armature
  int delay_ticks = 0;
  double period_s = 1e-3;
  Persons persons = Persons::kLinear;
};
[[nodiscard]] CoupledCase coupledCase(const CertificateInput& input);

/// The largest share over postures, frequencies, every Φ, and every constant α of the exercise's
/// walls. @pre c has an axis and an inertia, period_s > 0, every device damping > 0
[[nodiscard]] RequiredShare requiredShare(const CoupledCase& c);

}  // namespace wholehand
