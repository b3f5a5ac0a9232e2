#pragma once

#include "control/certificate/certificate_fingerprint.hpp"

#include <nlohmann/json.hpp>

namespace wholehand {

/// Adds to a certificate its fingerprint ("fingerprint") and, last, a digest of everything else.
void seal(nlohmann::ordered_json& certificate, const CertificateFingerprint& about);

}  // namespace wholehand
