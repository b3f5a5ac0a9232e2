#pragma once

#include "control/certificate/certificate.hpp"

#include <array>
#include <string>

namespace wholehand {

/// Version of the criteria; raised when they change.
inline constexpr int kCertificateVersion = 1;

/// Name of one input of a certificate, and a hash of all its numbers.
struct FingerprintPart {
  std::string name;  ///< name of the device, gains, hand or exercise; may be empty
  std::string hash;  ///< 16 hexadecimal digits
};

/// Everything a certificate depends on. Equal fingerprints mean equal certificates.
struct CertificateFingerprint {
  int version = kCertificateVersion;
  double rate_hz = 0.0;
  /// "device", "rendering", "hand", "exercise", in this order.
  std::array<FingerprintPart, 4> parts;
};
inline constexpr std::array<const char*, 4> kFingerprintParts = {"device", "rendering", "hand",
                                                                 "exercise"};

/// Fingerprint of the numbers only: comments, names and key order of the files do not matter. The
/// hand counts by its inertias, to nine digits, because compilers differ in the last ones.
[[nodiscard]] CertificateFingerprint fingerprintOf(const CertificateInput& input);

/// 64-bit FNV-1a as 16 hexadecimal digits. Detects accidental changes, not forgery.
[[nodiscard]] std::string hashOf(const std::string& text);

/// The differences as a sentence ("is for the device lambda-pride, this run uses wrist-9axis;
/// ..."); empty when there are none. Hand and exercise are compared only on the same device.
[[nodiscard]] std::string differenceOf(const CertificateFingerprint& certificate,
                                       const CertificateFingerprint& run);

}  // namespace wholehand
