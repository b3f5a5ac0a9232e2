#pragma once

#include "certify/certificate.hpp"
#include "loop/core/expected.hpp"

#include <string>

namespace wholehand {

/// Reads the fingerprint of a certificate file (`certify --json`). Refused unless the file is
/// intact and certified. For RigOptions::certificate.
[[nodiscard]] Expected<CertificateFingerprint> readCertificate(const std::string& path);

}  // namespace wholehand
