#pragma once

#include "certify/stability.hpp"

#include <complex>

namespace wholehand {

/// One axis of a device as the person feels it: the loop of AxisLoop with the whole avatar, whose
/// inertia couples its axes. The other axes of the device are held still; those of the avatar move.
struct FeltLoop {
  AxisLoop loop;       ///< of the axis; its person is not part of the impedance
  int axis = 0;        ///< its index in the following
  AxisMatrix inertia;  ///< M_r of the avatar in the posture, armature included [kg or kg·m²]
  AxisStiffness k_pm;  ///< of every axis
  AxisDamping avatar_damping;  ///< D of every axis in the posture
};

/// The axis alone, without inertial coupling, as in the certificate. Unit inertia.
[[nodiscard]] FeltLoop feltUncoupled(const AxisLoop& loop);

/// Impedance felt by the person at one frequency, effort over velocity [N·s/m or N·m·s/rad].
struct FeltImpedance {
  std::complex<double> felt;      ///< of device and rendering together
  std::complex<double> rendered;  ///< without the device's mass and damping
};

/// Z(jω) = P / (jω X) of the sampled loop, exact below half the rate. The person's effort P is a
/// sine in continuous time, X the phasor of the position that the device reads. The device is
/// continuous, its effort held and `delay_ticks` late. Velocity filter, γ, Φ and wall are those of
/// Eq. (3). The avatar is Eq. (2) by symplectic Euler, all axes coupled. kObject is the mass and
/// the spring of AxisLoop, solved implicitly like the contacts of an engine.
///
/// With Z_d = jωm + b, R(z) effort over position, G(z) the device under a held effort:
///   Z = Z_d (1 − G(z) z⁻ⁿ R(z)),  z = e^{jωT}.
/// At low frequency: felt mass m + K_pm (1 + (1 − γ) k_d τ_f) / k_p in free motion; felt stiffness
/// K_pm against a rigid stop, and 1 / (1/K_pm + 1/k_o) against a spring k_o.
/// @pre 0 < frequency_hz < 1 / (2 T), mass > 0
[[nodiscard]] FeltImpedance feltImpedance(const FeltLoop& felt, ContactCase contact,
                                          double frequency_hz);

/// Gain of a sine whose samples are joined by straight lines, in its effect on the bare device at
/// the sampling instants. About (sin(ωT/2) / (ωT/2))², 0.97 at a tenth of the rate.
[[nodiscard]] std::complex<double> linearHoldGain(const AxisLoop& loop, double frequency_hz);

}  // namespace wholehand
