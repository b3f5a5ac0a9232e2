#pragma once

#include "assembly/models.hpp"
#include "assembly/rig.hpp"

#include <string>

namespace wholehand {

/// Fingerprint of everything that determines the worst contacts and their cost: device, hand,
/// gains, scene, exercise, engine and rate; not the patient. Rigs with equal fingerprints have
/// equal rehearsals.
[[nodiscard]] std::string rehearsalFingerprint(const Models& models, const RigOptions& options,
                                               const CertificateFingerprint& certified);

}  // namespace wholehand
