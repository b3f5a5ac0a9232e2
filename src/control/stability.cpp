#include "control/stability.hpp"

#include "control/critical_damping.hpp"
#include "control/gain_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace wholehand {

namespace {

/// Rounding of an eigenvalue that is structurally 1 (rigid drift) stays well below it.
constexpr double kTolerance = 1e-7;
/// Φ moves between 0 and 1, so every value must hold; more damping is not always more margin.
constexpr std::array<double, 5> kSampledPhi = {0.0, 0.25, 0.5, 0.75, 1.0};

/// One axis with all that the search for an allowed value needs.
struct Candidate {
  const DeviceModel& device;
  const DeviceAxis& axis;
  const AxisRendering& rendering;
  const CouplingGains& gains;
  int index;
  double period_s;

  /// The loop with another stiffness and damping; K_ps follows K_pm where the rule sets it.
  [[nodiscard]] AxisLoop loop(double k_pm, double k_dm, double phi) const {
    AxisLoop l = axisLoop(device, gains, index, period_s);
    l.k_pm = k_pm;
    l.phi_k_dm = phi * k_dm;
    if (rendering.k_ps_per_s2 <= 0.0) {
      const double inertia =
          gains.k_pm[index] / (gains.k_ps_per_s2[index] * gains.contact_scale[index]);
      l.k_ps_per_s2 = ruleStiffness(k_pm, inertia);
      l.k_ds_per_s = criticalDamping(l.k_ps_per_s2, period_s);
    }
    return l;
  }
};

struct Verdict {
  double radius = 0.0;
  double phi = 0.0;
  ContactCase contact = ContactCase::kFree;
  [[nodiscard]] bool stable() const { return radius <= 1.0 + kTolerance; }
};

/// The worst case over Φ, free and against a rigid stop.
Verdict judge(const Candidate& c, double k_pm, double k_dm) {
  Verdict worst;
  for (const double phi : kSampledPhi) {
    for (const ContactCase contact : {ContactCase::kFree, ContactCase::kRigid}) {
      const double radius = spectralRadius(closedLoopMatrix(c.loop(k_pm, k_dm, phi), contact));
      if (!(radius <= worst.radius)) worst = {radius, phi, contact};
    }
  }
  return worst;
}

std::string perUnit(const DeviceAxis& axis, const char* time) {
  return axis.kind == AxisKind::kTranslation ? fmt::format("N{}/m", time)
                                             : fmt::format("N·m{}/rad", time);
}

/// The key of the rendering file.
std::string stiffnessKey(const DeviceAxis& axis) {
  return axis.kind == AxisKind::kTranslation ? "k_pm_n_m" : "k_pm_nm_rad";
}
std::string dampingKey(const DeviceAxis& axis) {
  return axis.kind == AxisKind::kTranslation ? "k_dm_n_s_m" : "k_dm_nm_s_rad";
}

std::string remedy(const Candidate& c, double k_pm, double k_dm) {
  const std::string at =
      fmt::format(" (device damping {:.4g} {}, {} tick{} of delay, {:.4g} Hz)", c.axis.damping,
                  perUnit(c.axis, "·s"), c.device.output_delay_ticks,
                  c.device.output_delay_ticks == 1 ? "" : "s", 1.0 / c.period_s);
  const double stiffness =
      roundedDown(largestAllowed(k_pm, [&](double k) { return judge(c, k, k_dm).stable(); }));
  std::string out;
  if (stiffness > 0.0) {
    out = fmt::format("largest allowed {}: {:.6g} {}", stiffnessKey(c.axis), stiffness,
                      perUnit(c.axis, ""));
  }
  const double damping =
      roundedDown(largestAllowed(k_dm, [&](double d) { return judge(c, k_pm, d).stable(); }));
  if (damping > 0.0) {
    out += fmt::format("{} {}: {:.6g} {}", out.empty() ? "largest allowed" : ", or",
                       dampingKey(c.axis), damping, perUnit(c.axis, "·s"));
  }
  if (out.empty()) {
    out =
        "no smaller stiffness is stable with this damping: lower the damping gain, or raise the "
        "device's";
  }
  return out + at;
}

Diagnostic refuse(const Candidate& c, const std::string& path, const Verdict& verdict) {
  const double k_pm = c.gains.k_pm[c.index];
  Diagnostic d;
  d.file = path;
  d.key = c.axis.name + "." + stiffnessKey(c.axis);
  d.value = fmt::format("{:.6g} {}", k_pm, perUnit(c.axis, ""));
  d.problem =
      fmt::format("unstable {} at Φ = {:g}: spectral radius {:.6g} > 1",
                  verdict.contact == ContactCase::kFree ? "in free motion" : "against a rigid stop",
                  verdict.phi, verdict.radius);
  d.remedy = remedy(c, k_pm, c.gains.k_dm[c.index]);
  return d;
}

/// Eq. (4) with M_r⁻¹ M̃_r instead of 1: inertia couples the axes of the avatar.
Diagnostics checkAvatar(const std::string& path, const CouplingGains& gains,
                        const std::vector<AxisMatrix>& inertias, double period_s) {
  const Eigen::VectorXd k_ps = gains.k_ps_per_s2.vec();
  const ShakingPosture worst = worstPosture(inertias, k_ps, period_s);
  if (worst.radius < 1.0) return {};
  const double factor = allowedFactor(inertias, k_ps, period_s);
  Diagnostic d;
  d.file = path;
  d.key = "k_ps_per_s2";
  d.problem = fmt::format(
      "the simulated hand's axes shake each other in posture {} of {}: spectral radius {:.6g} >= 1",
      worst.posture + 1, inertias.size(), worst.radius);
  d.remedy = factor > 0.0
                 ? fmt::format("multiply every axis's avatar stiffness by at most {:.3g}", factor)
                 : "the hand's reduced inertia is singular: check its masses and synergies";
  return {d};
}

}  // namespace

Diagnostics checkStability(const DeviceModel& device, const RenderingConfig& rendering,
                           const CouplingGains& gains,
                           const std::vector<AxisMatrix>& reduced_inertias, double period_s) {
  Diagnostics out;
  for (int i = 0; i < gains.axes; ++i) {
    const Candidate c{device, device.axes[i], rendering.axes[i], gains, i, period_s};
    const Verdict verdict = judge(c, gains.k_pm[i], gains.k_dm[i]);
    if (!verdict.stable()) out.push_back(refuse(c, rendering.path, verdict));
  }
  const Diagnostics avatar = checkAvatar(rendering.path, gains, reduced_inertias, period_s);
  out.insert(out.end(), avatar.begin(), avatar.end());
  return out;
}

}  // namespace wholehand
