#pragma once

#include "control/certificate_fingerprint.hpp"

#include <nlohmann/json.hpp>

namespace wholehand {

/// Adds to a certificate what it is about ("fingerprint") and, last, a digest of all the rest.
void seal(nlohmann::ordered_json& certificate, const CertificateFingerprint& about);

}  // namespace wholehand
