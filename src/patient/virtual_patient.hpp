#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/patient_config.hpp"

namespace wholehand {

/// What the person applies to the device on one axis: K (q_i - q) + B (q̇_i - q̇) [N or N·m]. The
/// person's own inertia is not in it: it moves with the device. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double impedanceEffort(const PatientAxis& person, double q, double qd,
                                                  double q_intended, double qd_intended) noexcept;

/// What links add on one axis: the others' K e + B ė, e and ė how far the intention is ahead
/// [N or N·m]. 0 where nothing is linked. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double linkedEffort(const PatientLinks& links, int axis,
                                               const AxisPosition& e,
                                               const AxisVelocity& ed) noexcept;

/// Impedance of every axis, with what links them: f = K (q_i - q) + B (q̇_i - q̇), K and B symmetric.
/// @pre all arrays have the patient's number of axes. Real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort patientEffort(const PatientConfig& patient,
                                                    const AxisPosition& q, const AxisVelocity& qd,
                                                    const AxisPosition& q_intended,
                                                    const AxisVelocity& qd_intended) noexcept;

}  // namespace wholehand
