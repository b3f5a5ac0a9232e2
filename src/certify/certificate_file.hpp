#pragma once

#include "certify/certificate.hpp"
#include "loop/core/expected.hpp"

#include <string>

namespace wholehand {

/// Reads the fingerprint of a certificate file (`certify --json`) for RigOptions::certificate.
/// Refuses a file that is not intact or not certified.
[[nodiscard]] Expected<CertificateFingerprint> readCertificate(const std::string& path);

}  // namespace wholehand
