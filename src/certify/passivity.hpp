#pragma once

#include "certify/certificate.hpp"
#include "certify/stability.hpp"

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
/// The bound is exact: with less damping some passive person and object oscillate.
/// `loop.damping` and `loop.mass` have no influence. Infinite where r₂₂ <= 0: the avatar itself is
/// active.
///
/// Person: device and person have the admittance Y(s). Without b they are passive: Y(jω) lies in
/// the disc |Y − 1/2b| <= 1/2b. Under sampling and hold the loop sees the mean over the images ω_k
/// = (φ + 2πk)/T: Σ w_k Y(jω_k), w_k = (2 sin(φ/2)/(φ + 2πk))², Σ w_k = 1. It lies in the disc: it
/// is 1/(b + W), Re W >= 0. A lossless person of masses and springs (Foster) reaches each edge
/// point.
///
/// Object: its impedance Z(z), force over velocity after the tick, has Re Z >= 0. With
/// r = (1 − z⁻¹)/T + T K_ps/(z − 1) + K_ds z⁻¹, Re r = r₂₂, the values of 1/(r + Z) fill the disc
/// of radius 1/2r₂₂ that touches 0; on it Re q/(r + Z) <= (Re q + |q|)/2r₂₂.
///
/// Loop: it sustains φ where b + W + A₀ − q/(r + Z) = 0. With more damping than the bound no W, Z
/// solve this. Every person and object deform continuously into stiff dashpots, which are stable,
/// and no pole crosses the unit circle: sufficient. With less, the edge W, Z solve it for the
/// bound, and the missing damping moves the pole out: necessary.
/// tests/certify/worst_termination.hpp builds them.
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
/// (S-procedure for two Hermitian forms, lossless).
///
/// Sufficient: Re xᴴ(Q_m y − (b + A₀) x) = Re xᴴW x >= 0 and Re yᴴ(Q_s x − R y) = Re yᴴZ y >= 0.
/// The first plus λ times the second is a Hermitian form of (x, y) that must be >= 0. Where it is
/// negative definite for some λ > 0, no x, y exist: by Schur's complement the criterion. Necessary:
/// both forms are >= 0 at some (x, y) unless such a λ exists. W with W x = u, Re W >= 0, exists
/// whenever Re xᴴu >= 0. So below the bound some linked person and object solve the equations.
///
/// For one axis the best λ = |Q_m|/|Q_s| gives b_min of requiredDamping(). As φ → 0, Q_m/Q_sᴴ is
/// the ratio of the felt to the acting spring. If the axes differed in it, no damping would
/// suffice.
///
/// That λ may differ from one frequency to the next, so the condition is of linear, time-invariant
/// persons and objects, and of a constant Φ. With λ = 1 at every frequency it is an inequality of
/// energies over time (Parseval), which any passive person and object obey, nonlinear and
/// time-varying ones, too. A Φ that changes with every tick is w = Φ u, u = g ẋ the filtered
/// velocity; w (u − w) >= 0, weighed by p K_dm, joins the inequality:
///   b + Re A₀(Φ = 0) − E (4 Re R)⁻¹ Eᴴ − K_dm |zⁿ − p g|²/4p  is positive definite for one p > 0,
///   g = T/((τ + T) z − τ).
/// The least over w leaves the last term; one p serves all postures. Passive persons and objects
/// give no energy in the end, so the motion comes to rest. This is sufficient, not necessary. The
/// person's side is exact between ticks; the avatar's is that of engine steps.
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
