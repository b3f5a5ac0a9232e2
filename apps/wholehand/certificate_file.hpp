#pragma once

#include "control/certificate_fingerprint.hpp"
#include "core/expected.hpp"

#include <nlohmann/json.hpp>

#include <string>

namespace wholehand {

/// Adds to a certificate what it is about ("fingerprint") and, last, a digest of all the rest.
void seal(nlohmann::ordered_json& certificate, const CertificateFingerprint& about);

/// What a certificate file (`certify --json`) is about, where it is whole and says certified; else
/// why not.
[[nodiscard]] Expected<CertificateFingerprint> readCertificate(const std::string& path);

}  // namespace wholehand
