#pragma once

#include "certify/certificate_refusal.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// A certificate with its advice.
struct AdvisedCertificate {
  CertificateInput input;
  Certificate certificate;
  std::vector<AxisAdvice> advice;                    ///< one per axis
  std::optional<std::vector<NearestGains>> nearest;  ///< only if not certified
  std::string corner;  ///< "the worst corner of the passport ..."; empty: the device file
};

/// Tables and conclusion that `certify` prints.
[[nodiscard]] std::string certificateText(const AdvisedCertificate& judged);

/// JSON of `certify --json` (docs/certificate.md); infinite limits are null.
[[nodiscard]] nlohmann::ordered_json certificateJson(const AdvisedCertificate& judged);

}  // namespace wholehand
