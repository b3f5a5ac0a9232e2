#pragma once

#include "assembly/models.hpp"
#include "assembly/rig.hpp"

#include <string>

namespace wholehand {

/// Of the numbers that decide what the worst contacts are and what a tick of them costs: device,
/// hand, gains, scene, exercise, engine and rate; not of the patient. Two rigs with the same one
/// rehearse the same.
[[nodiscard]] std::string rehearsalFingerprint(const Models& models, const RigOptions& options,
                                               const CertificateFingerprint& certified);

}  // namespace wholehand
