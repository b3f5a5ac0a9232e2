#pragma once

#include "certify/stability.hpp"

#include <complex>

namespace wholehand {

/// Loop of one device axis that the person moves. It combines AxisLoop with the whole avatar, whose
/// inertia couples its axes. The other axes of the device are held still; those of the avatar move.
struct FeltLoop {
  AxisLoop loop;       ///< loop of the axis; its person is not part of the impedance
  int axis = 0;        ///< index of the axis in the members below
  AxisMatrix inertia;  ///< M_r of the avatar in the posture, armature included [kg or kg·m²]
  AxisStiffness k_pm;  ///< K_pm of every axis
  AxisDamping avatar_damping;  ///< D of every axis in the posture
};

/// The axis alone with unit inertia and without inertial coupling, as in the certificate.
[[nodiscard]] FeltLoop feltUncoupled(const AxisLoop& loop);

/// Impedance rendered to the person at one frequency, effort over velocity [N·s/m or N·m·s/rad].
struct FeltImpedance {
  std::complex<double> felt;      ///< impedance of device and rendering together
  std::complex<double> rendered;  ///< without the device's mass and damping
};

/// Z(jω) = P / (jω X) of the sampled loop, exact below half the rate. The person's effort P is a
/// sine in continuous time; X is the phasor of the position that the device reads. The device is
/// continuous; its effort is held and delayed by `delay_ticks`. Velocity filter, γ, Φ and wall are
/// those of Eq. (3). The avatar is Eq. (2) by symplectic Euler, all axes coupled. kObject means the
/// mass and the spring of AxisLoop, solved implicitly like the contacts of an engine.
///
/// With Z_d = jωm + b, R(z) the effort per position and G(z) the device under a held effort:
///   Z = Z_d (1 − G(z) z⁻ⁿ R(z)),  z = e^{jωT}.
/// At low frequency: rendered mass m + K_pm (1 + (1 − γ) k_d τ_f) / k_p in free motion; rendered
/// stiffness K_pm against a rigid stop, and 1 / (1/K_pm + 1/k_o) against a spring k_o.
/// @pre 0 < frequency_hz < 1 / (2 T), mass > 0
[[nodiscard]] FeltImpedance feltImpedance(const FeltLoop& felt, ContactCase contact,
                                          double frequency_hz);

/// Effect of a sine whose samples are joined by straight lines on the bare device at the sampling
/// instants, relative to a continuous sine. About (sin(ωT/2) / (ωT/2))², 0.97 at a tenth of the
/// rate.
[[nodiscard]] std::complex<double> linearHoldGain(const AxisLoop& loop, double frequency_hz);

}  // namespace wholehand
