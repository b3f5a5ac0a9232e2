#pragma once

#include "control/certificate_fingerprint.hpp"
#include "core/expected.hpp"

#include <string>

namespace wholehand {

/// What a certificate file (`certify --json`) is about, where it is whole and says certified; else
/// why not. For RigOptions::certificate.
[[nodiscard]] Expected<CertificateFingerprint> readCertificate(const std::string& path);

}  // namespace wholehand
