#pragma once

#include "control/stability.hpp"

#include <complex>

namespace wholehand {

/// One axis of a device as the person feels it: the loop of AxisLoop with the whole avatar behind
/// it, whose inertia couples its axes. The device's other axes are held still; the avatar's are
/// not.
struct FeltLoop {
  AxisLoop loop;       ///< of the axis; its person does not count: who feels is not felt
  int axis = 0;        ///< row of it in what follows
  AxisMatrix inertia;  ///< M_r of the avatar in the posture, armature included [kg or kg·m²]
  AxisRatio k_pm;      ///< of every axis
  AxisRatio avatar_damping;  ///< D of every axis in the posture
};

/// An axis by itself, as if the avatar's inertia coupled nothing: the certificate's view. Of unit
/// inertia.
[[nodiscard]] FeltLoop feltAlone(const AxisLoop& loop);

/// What the person feels at one frequency, effort over velocity [N·s/m or N·m·s/rad].
struct FeltImpedance {
  std::complex<double> felt;      ///< device and rendering: what the hand feels
  std::complex<double> rendered;  ///< without the device's own mass and damping
};

/// Z(jω) = P / (jω X) of the sampled loop, exact below half the rate: the person's effort P is a
/// sine in continuous time, X the phasor of the position that the device reads. The device is
/// continuous with a held effort that comes `delay_ticks` late; velocity filter, γ, Φ and wall are
/// Eq. (3)'s; the avatar is Eq. (2) by symplectic Euler, all axes coupled; kObject is the mass and
/// the spring of AxisLoop, solved implicitly as an engine solves contacts.
///
/// With Z_d = jωm + b, R(z) the effort over the position, G(z) the device under a held effort:
///   Z = Z_d (1 − G(z) z⁻ⁿ R(z)),  z = e^{jωT}.
/// At low frequency: felt mass m + K_pm (1 + (1 − γ) k_d τ_f) / k_p in free motion; felt stiffness
/// K_pm against a rigid stop, and 1 / (1/K_pm + 1/k_o) against a spring k_o.
/// @pre 0 < frequency_hz < 1 / (2 T), mass > 0
[[nodiscard]] FeltImpedance feltImpedance(const FeltLoop& felt, ContactCase contact,
                                          double frequency_hz);

/// What a sine becomes when only its samples are applied, joined by straight lines: the factor on
/// its effect on the bare device at the sampling instants. About (sin(ωT/2) / (ωT/2))², 0.97 at a
/// tenth of the rate.
[[nodiscard]] std::complex<double> linearHoldGain(const AxisLoop& loop, double frequency_hz);

}  // namespace wholehand
