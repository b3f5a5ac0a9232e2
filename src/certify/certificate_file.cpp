#include "certify/certificate_file.hpp"

#include "certify/certificate.hpp"
#include "certify/certificate_refusal.hpp"
#include "certify/certificate_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>

/// Writes and seals the JSON of a certificate, and reads its fingerprint back.
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

/// Adds the fingerprint ("fingerprint") to a certificate, and then a digest of everything else.
void seal(Json& certificate, const CertificateFingerprint& about) {
  Json json;
  json["criteria"] = about.version;
  json["rate_hz"] = about.rate_hz;
  for (std::size_t i = 0; i < kFingerprintParts.size(); ++i) {
    json[kFingerprintParts[i]] = {{"name", about.parts[i].name}, {"hash", about.parts[i].hash}};
  }
  certificate["fingerprint"] = json;
  // The digest is of the text as read back, because infinite limits are null in the file.
  certificate["digest"] = digestOf(Json::parse(certificate.dump()));
}

constexpr std::array<const char*, kContactCriteria> kContactKeys = {"free", "rigid", "mass",
                                                                    "spring"};

Json wallJson(const AxisCertificate& a) {
  if (a.axis_case.walls.empty()) return nullptr;
  const WallCertificate& w = a.wall;
  return {
      {"stiffness", w.wall.stiffness},
      {"damping", w.wall.damping},
      {"damping_required", w.damping_required},
      {"damping_required_phi", w.damping_required_phi},
      {"spectral_radius", w.worst.radius},
      {"worst_case", {{"alpha", w.worst.alpha}, {"phi", w.worst.phi}, {"person", w.worst.person}}},
      {"margin", w.margin}};
}

Json axisJson(const AxisCertificate& a, const AxisAdvice& advice) {
  Json json;
  json["name"] = a.axis_case.axis.name;
  json["unit"] =
      fmt::format("{}/{}", a.axis_case.axis.effortUnit(), a.axis_case.axis.positionUnit());
  json["k_pm"] = a.axis_case.gains.k_pm;
  json["k_dm"] = a.axis_case.gains.k_dm;
  json["gamma"] = a.axis_case.gains.gamma;
  json["armature"] = a.axis_case.armature();
  json["k_ps_per_s2"] = a.axis_case.avatarStiffness();
  json["rigid_contact_limit"] = a.rigid_limit;
  json["rigid_contact_formula"] = a.rigid_formula;
  for (std::size_t i = 0; i < kContactKeys.size(); ++i) {
    const WorstRadius& worst = a.contacts[i];
    json["spectral_radius"][kContactKeys[i]] = worst.radius;
    json["worst_case"][kContactKeys[i]] = {{"phi", worst.phi}, {"person", worst.person}};
    if (worst.object > 0.0) json["worst_case"][kContactKeys[i]]["object"] = worst.object;
  }
  json["damping_required"] = a.damping_required;
  json["damping_required_phi"] = a.damping_required_phi;
  json["damping_available"] = a.axis_case.axis.damping;
  json["quantisation_limit"] = a.quantisationLimit();
  json["viscous_limit"] = a.viscous_limit;
  json["coulomb_limit"] = a.coulomb_limit;
  json["wall"] = wallJson(a);
  json["slew_required"] = a.slew_required;
  json["slew_available"] = a.axis_case.axis.effort_slew_limit;
  json["passes"] = a.passes;
  json["fails"] = failing(a);
  json["binding"] = criterionKey(a.binding);
  json["margin"] = a.margin;
  for (std::size_t i = 0; i < kAdmittedRatesHz.size(); ++i) {
    json["admitted_k_pm"][fmt::format("{:.0f}", kAdmittedRatesHz[i])] = advice.admitted_k_pm[i];
  }
  json["best_gamma"] = {{"gamma", advice.best_gamma}, {"k_pm", advice.best_gamma_k_pm}};
  return json;
}

}  // namespace

Expected<CertificateFingerprint> readCertificate(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream in(path, std::ios::binary);
  if (error || !in) return fileFault(path, "cannot be read", "check the path");
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
    return keyFault(path, "certified", "false",
                    fmt::format("says that these gains are not certified (binding: {})",
                                json.at("binding").get<std::string>()),
                    "certify gains that pass");
  } catch (const Json::exception&) {
    return fault(path, "is damaged: an entry is missing or of another kind");
  }
}

Json certificateJson(const AdvisedCertificate& judged) {
  const Certificate& c = judged.certificate;
  Json json;
  json["certified"] = c.certified;
  json["binding"] = c.binding();
  json["margin"] = c.margin();
  json["rate_hz"] = 1.0 / c.period_s;
  json["device"] = judged.input.device.name;
  json["corner"] = judged.corner.empty() ? Json() : Json(judged.corner);
  json["rendering"] = judged.input.rendering.name;
  json["hand"] = judged.input.hand;
  json["exercise"] = judged.input.exercise.empty() ? Json() : Json(judged.input.exercise);
  json["level"] = judged.input.level > 0 ? Json(judged.input.level) : Json();
  json["axes"] = Json::array();
  for (std::size_t i = 0; i < c.axes.size(); ++i) {
    json["axes"].push_back(axisJson(c.axes[i], judged.advice[i]));
    if (!judged.nearest) continue;
    const NearestGains& nearest = (*judged.nearest)[i];
    json["axes"].back()["nearest"] = {{"k_pm", nearest.k_pm}, {"k_dm", nearest.k_dm}};
    if (nearest.armature) json["axes"].back()["nearest"]["armature"] = *nearest.armature;
  }
  json["avatar"] = {{"spectral_radius", c.avatar.radius}, {"worst_posture", c.avatar.posture + 1},
                    {"postures", c.avatar.postures},      {"slowest_s", c.avatar.slowest_s},
                    {"margin", c.avatar.margin},          {"passes", c.avatar.passes()}};
  json["coupled"] = {{"margin", c.coupled.margin},
                     {"frequency_hz", c.coupled.frequency_hz},
                     {"worst_posture", c.coupled.posture},
                     {"passes", c.coupled.margin >= 1.0}};
  json["any_person"] = {{"margin", c.any_person.margin},
                        {"frequency_hz", c.any_person.frequency_hz},
                        {"worst_posture", c.any_person.posture},
                        {"passes", c.any_person.margin >= 1.0}};
  seal(json, fingerprintOf(judged.input));
  return json;
}

}  // namespace wholehand
