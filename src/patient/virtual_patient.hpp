#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/patient/patient_config.hpp"

namespace wholehand {

/// Effort of the person's impedance on one axis: K (q_i - q) + B (q̇_i - q̇) [N or N·m]. The
/// person's inertia is excluded; it moves with the device. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double impedanceEffort(const PatientAxis& person, double q, double qd,
                                                  double q_intended, double qd_intended) noexcept;

/// Position and speed towards which a person of limited strength pulls: those intended, or nearer
/// ones at which the impedance's effort is the axis's strength. Real-time safe.
struct Pull {
  double q, qd;
};
[[nodiscard]] WHOLEHAND_RT Pull pullOf(const PatientAxis& person, double q, double qd,
                                       double q_intended, double qd_intended) noexcept;

/// Effort that links add on one axis: the other axes' K e + B ė, e and ė the lead of the intention
/// [N or N·m]. 0 without links. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double linkedEffort(const PatientLinks& links, int axis,
                                               const AxisPosition& e,
                                               const AxisVelocity& ed) noexcept;

/// Impedance of every axis including links: f = K (q_i - q) + B (q̇_i - q̇), K and B symmetric.
/// @pre all arrays have the patient's number of axes. Real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort patientEffort(const PatientConfig& patient,
                                                    const AxisPosition& q, const AxisVelocity& qd,
                                                    const AxisPosition& q_intended,
                                                    const AxisVelocity& qd_intended) noexcept;

}  // namespace wholehand
