#pragma once

#include "control/certificate.hpp"

#include <array>
#include <string>

namespace wholehand {

/// Which criteria a certificate was judged by; raised when they change.
inline constexpr int kCertificateVersion = 1;

/// Names one of the things that a certificate is about, and all its numbers in a hash.
struct FingerprintPart {
  std::string name;  ///< of the device, the gains, the hand or the exercise; may be empty
  std::string hash;  ///< 16 hexadecimal digits
};

/// Everything a certificate depends on: two certificates with the same one say the same.
struct CertificateFingerprint {
  int version = kCertificateVersion;
  double rate_hz = 0.0;
  /// "device", "rendering", "hand", "exercise", in this order.
  std::array<FingerprintPart, 4> parts;
};
inline constexpr std::array<const char*, 4> kFingerprintParts = {"device", "rendering", "hand",
                                                                 "exercise"};

/// Of the numbers themselves: comments, names and the order of a file's keys play no part. The
/// hand counts by its inertias, to nine digits: compilers differ in the last ones.
[[nodiscard]] CertificateFingerprint fingerprintOf(const CertificateInput& input);

/// 64-bit FNV-1a as 16 hexadecimal digits: tells accidents, not forgers.
[[nodiscard]] std::string hashOf(const std::string& text);

/// What differs, as a sentence ("is for the device lambda-pride, this run uses wrist-9axis; ...");
/// empty where nothing does. Hand and exercise are
/// compared only on the same device.
[[nodiscard]] std::string differenceOf(const CertificateFingerprint& certificate,
                                       const CertificateFingerprint& run);

}  // namespace wholehand
