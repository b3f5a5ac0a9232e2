#pragma once

#include "control/certificate.hpp"

#include <cstddef>
#include <vector>

namespace wholehand {

/// How much of the device's damping the whole hand needs, so that it stays stable whatever passive
/// person holds it and whatever passive world it meets, *both of which may link its axes*: mass,
/// damping and stiffness of person and object are full matrices, a grasp ties fingers to thumb.
///
/// With x the device's velocities, y the avatar's, W and Z the impedances of person and world
/// (Hermitian parts >= 0), the loop swings for ever at the angle φ where
///   (b + A₀ + W) x = Q_m y,   (R + Z) y = Q_s x,  z = e^{jφ},
///   A₀  = T z⁻ⁿ (K_pm + αk + (γD + Φ K_dm + αd) d) / (z − 1),  d = (z − 1)/((τ + T) z − τ),
///   Q_m = z⁻ⁿ (K_pm T/(z − 1) + γD z⁻¹),   Q_s = (K_pm + D d) T/(z − 1),   all diagonal,
///   Re R = M_r (1 − cos φ)/T − T K_pm/2 + D cos φ,  M_r with all its couplings.
/// Some W and Z solve it unless for one λ > 0, *the same for all axes*,
///   b + Re A₀ − E (4 λ Re R)⁻¹ Eᴴ,   E = Q_m + λ Q_sᴴ,   is positive definite
/// (S-procedure for two Hermitian forms: without loss; docs/certificate.md). For one axis the best
/// λ gives b_min of requiredDamping(). As φ → 0 Q_m/Q_sᴴ is what is felt over what acts: were it
/// not the same on all axes, no damping would be enough.
struct CoupledNeed {
  double share = 0.0;         ///< of the device's damping; below 1 passes; +inf: none is enough
  double frequency_hz = 0.0;  ///< where it is the largest
  double lambda = 1.0;        ///< λ there
  std::size_t posture = 0;    ///< and the posture, from 0
};

/// What all axes together depend on.
struct CoupledCase {
  std::vector<AxisCase> axes;        ///< with their walls
  std::vector<AxisMatrix> inertias;  ///< of the sampled postures, armature included
  int delay_ticks = 0;
  double period_s = 1e-3;
};
[[nodiscard]] CoupledCase coupledCase(const CertificateInput& input);

/// The largest share over postures, frequencies, every Φ, and the walls of the exercise at every α.
[[nodiscard]] CoupledNeed requiredShare(const CoupledCase& c);

}  // namespace wholehand
