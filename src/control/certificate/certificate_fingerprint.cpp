#include "control/certificate/certificate_fingerprint.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

namespace wholehand {
namespace {

void add(std::string& text, double value) {
  text += fmt::format("{:.17g};", value);
}

std::string deviceText(const DeviceModel& device) {
  std::string text;
  add(text, device.output_delay_ticks);
  for (const DeviceAxis& a : device.axes) {
    text += a.kind == AxisKind::kTranslation ? 't' : 'r';
    for (const double value : {a.mass, a.damping, a.coulomb, a.encoder_step, a.lever_arm_m,
                               a.speed_limit, a.effort_slew_limit}) {
      add(text, value);
    }
  }
  return text;
}

std::string renderingText(const RenderingConfig& rendering) {
  std::string text;
  for (const AxisRendering& a : rendering.axes) {
    for (const double value :
         {a.k_pm, a.k_dm, a.gamma, a.velocity_filter_hz, a.armature.value_or(-1.0)}) {
      add(text, value);
    }
  }
  return text;
}

void addInertia(std::string& text, const AxisMatrix& m) {
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    text += fmt::format("{:.9g};", m(i, i));
    for (Eigen::Index j = 0; j < i; ++j) {
      // Entries are scaled by the diagonal, so that rounding of a zero entry stays zero on every
      // machine.
      text += fmt::format("{};", std::llround(1e9 * m(i, j) / std::sqrt(m(i, i) * m(j, j))));
    }
  }
}

std::string exerciseName(const CertificateInput& input) {
  return input.level > 0 ? fmt::format("{} level {}", input.exercise, input.level) : input.exercise;
}

}  // namespace

std::string hashOf(const std::string& text) {
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return fmt::format("{:016x}", hash);
}

CertificateFingerprint fingerprintOf(const CertificateInput& input) {
  std::string hand, walls;
  addInertia(hand, input.inertia_at_reference);
  for (const AxisMatrix& m : input.inertias) addInertia(hand, m);
  for (const CertificateInput::Wall& w : input.walls) {
    for (const double value :
         {static_cast<double>(w.axis), w.wall.stiffness, w.wall.damping, w.wall.resistance}) {
      add(walls, value);
    }
  }
  CertificateFingerprint out;
  out.rate_hz = 1.0 / input.period_s;
  out.parts = {{{input.device.name, hashOf(deviceText(input.device))},
                {input.rendering.name, hashOf(renderingText(input.rendering))},
                {input.hand, hashOf(hand)},
                {exerciseName(input), hashOf(walls)}}};
  return out;
}

std::string differenceOf(const CertificateFingerprint& certificate,
                         const CertificateFingerprint& run) {
  std::string out;
  const auto differs = [&out](const std::string& one, const std::string& other) {
    out += fmt::format("{}is for {}, this run {}", out.empty() ? "" : "; ", one, other);
  };
  if (certificate.version != run.version) {
    differs(fmt::format("criteria {}", certificate.version),
            fmt::format("goes by criteria {}", run.version));
  }
  if (std::abs(certificate.rate_hz - run.rate_hz) > 1e-9 * run.rate_hz) {
    differs(fmt::format("{:.6g} Hz", certificate.rate_hz),
            fmt::format("ticks at {:.6g} Hz", run.rate_hz));
  }
  const bool other_device = certificate.parts[0].hash != run.parts[0].hash;
  for (std::size_t i = 0; i < kFingerprintParts.size(); ++i) {
    const FingerprintPart &one = certificate.parts[i], &other = run.parts[i];
    if (one.hash == other.hash) continue;
    // On another device the same hand has another inertia, and the same exercise other walls.
    if (i >= 2 && other_device && one.name == other.name) continue;
    const auto named = [](const std::string& name) { return name.empty() ? "none" : name; };
    if (one.name == other.name) {
      differs(fmt::format("other numbers of the {} {}", kFingerprintParts[i], named(one.name)),
              "has changed ones");
    } else {
      differs(fmt::format("the {} {}", kFingerprintParts[i], named(one.name)),
              fmt::format("uses {}", named(other.name)));
    }
  }
  return out;
}

}  // namespace wholehand
