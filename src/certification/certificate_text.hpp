#pragma once

#include "control/certificate_advice.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// A certificate with what follows from it.
struct AdvisedCertificate {
  CertificateInput input;
  Certificate certificate;
  std::vector<AxisAdvice> advice;                    ///< one for each axis
  std::optional<std::vector<NearestGains>> nearest;  ///< only where not certified
  std::string corner;  ///< "the worst corner of the passport ...": input.device; empty: the file's
};

/// The tables and the sentence that `certify` prints.
[[nodiscard]] std::string certificateText(const AdvisedCertificate& judged);

/// What `certify --json` writes (docs/certificate.md); what has no limit is null.
[[nodiscard]] nlohmann::ordered_json certificateJson(const AdvisedCertificate& judged);

}  // namespace wholehand
