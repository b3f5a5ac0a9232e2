#include "certification/certificate_file.hpp"

#include "certification/certificate_seal.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace wholehand {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kLargest_bytes = 10'000'000;

Diagnostic fault(const std::string& path, const std::string& problem, const std::string& key = {}) {
  return {path, 0, key, "", problem, "write one with `wholehand certify --json F`"};
}

std::string digestOf(Json certificate) {
  certificate.erase("digest");
  return hashOf(certificate.dump());
}

CertificateFingerprint aboutOf(const Json& json) {
  CertificateFingerprint about;
  about.version = json.at("criteria").get<int>();
  about.rate_hz = json.at("rate_hz").get<double>();
  for (std::size_t i = 0; i < kFingerprintParts.size(); ++i) {
    const Json& part = json.at(kFingerprintParts[i]);
    about.parts[i] = {part.at("name").get<std::string>(), part.at("hash").get<std::string>()};
  }
  return about;
}

}  // namespace

void seal(Json& certificate, const CertificateFingerprint& about) {
  Json json;
  json["criteria"] = about.version;
  json["rate_hz"] = about.rate_hz;
  for (std::size_t i = 0; i < kFingerprintParts.size(); ++i) {
    json[kFingerprintParts[i]] = {{"name", about.parts[i].name}, {"hash", about.parts[i].hash}};
  }
  certificate["fingerprint"] = json;
  // Digest of the text as read back: infinite limits are null in the file.
  certificate["digest"] = digestOf(Json::parse(certificate.dump()));
}

Expected<CertificateFingerprint> readCertificate(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) return Diagnostic{path, 0, "", "", "cannot be read", "check the path"};
  if (size > kLargest_bytes) return fault(path, "is not a certificate: it is too large");
  const std::string text(std::istreambuf_iterator<char>(in), {});
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return fault(path, "is damaged, or no JSON at all");
  if (!json.is_object() || !json.contains("certified") || !json.contains("fingerprint") ||
      !json.contains("digest")) {
    return fault(path, "is not a certificate");
  }
  try {
    if (json.at("digest").get<std::string>() != digestOf(json)) {
      return fault(path, "was changed after it was written: its contents do not fit its digest");
    }
    const CertificateFingerprint about = aboutOf(json.at("fingerprint"));
    if (json.at("certified").get<bool>()) return about;
    return Diagnostic{path,
                      0,
                      "certified",
                      "false",
                      fmt::format("says that these gains are not certified (binding: {})",
                                  json.at("binding").get<std::string>()),
                      "certify gains that pass"};
  } catch (const Json::exception&) {
    return fault(path, "is damaged: an entry is missing or of another kind");
  }
}

}  // namespace wholehand
