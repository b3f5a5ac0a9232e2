#include "control/certificate/certificate_refusal.hpp"

#include "control/passivity.hpp"
#include "control/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

const char* contactWords(Criterion criterion) {
  switch (criterion) {
    case Criterion::kFree:
      return "in free motion";
    case Criterion::kRigid:
      return "against a rigid stop";
    case Criterion::kMass:
      return "with an object in hand";
    default:
      return "against a spring";
  }
}

std::string findingInWall(const AxisCertificate& a) {
  const DeviceAxis& axis = a.axis_case.axis;
  const WallCertificate& w = a.wall;
  const std::string where =
      fmt::format("in the exercise's wall of {:.4g} {} and {:.3g} {} ", w.wall.stiffness,
                  perUnit(axis), w.wall.damping, perUnit(axis, "·s"));
  if (!w.worst.stable()) {
    return where + fmt::format("it is unstable at α = {:g}, Φ = {:g}: spectral radius {:.6g} > 1",
                               w.worst.alpha, w.worst.phi, w.worst.radius);
  }
  if (quantisationLimit(a.axis_case) <= w.margin * (a.axis_case.gains.k_pm + w.wall.stiffness)) {
    return where + fmt::format("quantisation allows {:.4g} {} in all, it is {:.4g}",
                               quantisationLimit(a.axis_case), perUnit(axis),
                               a.axis_case.gains.k_pm + w.wall.stiffness);
  }
  return where + fmt::format(
                     "any passive person and object need {:.3g} {} of device damping (at Φ = "
                     "{:g}), it has {:.3g}",
                     w.damping_required, perUnit(axis, "·s"), w.damping_required_phi, axis.damping);
}

/// "largest allowed k_pm_n_m: 1650 N/m (device damping 6 N·s/m, 1 tick of delay, 1000 Hz)"
std::string remedy(const AxisCertificate& a) {
  const AxisCase& c = a.axis_case;
  const NearestGains nearest = nearestOfAxis(c);
  const double share = a.binding == Criterion::kWall ? bearableWallShare(c) : 0.0;
  const std::string softer =
      share > 0.0 ? fmt::format(", or at most {:.2g} of the wall's stiffness and damping", share)
                  : std::string{};
  if (!(nearest.k_pm > 0.0)) {
    return "no smaller gains pass: the device needs more damping, less delay or a faster loop" +
           softer;
  }
  std::string out = fmt::format("largest allowed {}: {:.6g} {}", stiffnessKey(c.axis), nearest.k_pm,
                                perUnit(c.axis));
  if (nearest.k_dm != c.gains.k_dm) {
    out += fmt::format(" with {} = {:.6g}", dampingKey(c.axis), nearest.k_dm);
  }
  return out + softer +
         fmt::format(" (device damping {:.4g} {}, {} tick{} of delay, {:.4g} Hz)", c.axis.damping,
                     perUnit(c.axis, "·s"), c.delay_ticks, c.delay_ticks == 1 ? "" : "s",
                     1.0 / c.period_s);
}

/// "unstable against a rigid stop at Φ = 0: spectral radius 1.01 > 1; ", put before the binding
/// criterion because instability is worse. Empty where no contact is unstable or the unstable one
/// binds.
std::string instability(const AxisCertificate& a) {
  const WorstRadius* worst = nullptr;
  auto contact = Criterion::kFree;
  for (int i = 0; i < kContactCriteria; ++i) {
    const WorstRadius& found = a.contacts[i];
    if (found.stable() || (worst != nullptr && found.radius <= worst->radius)) continue;
    worst = &found;
    contact = static_cast<Criterion>(i);
  }
  if (worst == nullptr || static_cast<int>(a.binding) < kContactCriteria) return {};
  return fmt::format("unstable {} at Φ = {:g}: spectral radius {:.6g} > 1; ", contactWords(contact),
                     worst->phi, worst->radius);
}

Diagnostic refusal(const AxisCertificate& a, const std::string& path) {
  Diagnostic d;
  d.file = path;
  d.key = a.axis_case.axis.name + "." + stiffnessKey(a.axis_case.axis);
  d.value = fmt::format("{:.6g} {}", a.axis_case.gains.k_pm, perUnit(a.axis_case.axis));
  d.problem = fmt::format("not certified ({}): {}", fmt::join(failing(a), ", "),
                          instability(a) + finding(a));
  d.remedy = remedy(a);
  return d;
}

Diagnostic avatarRefusal(const Certificate& c, const std::string& path) {
  Diagnostic d;
  d.file = path;
  d.key = "armature";
  const bool shakes = !(c.avatar.radius < 1.0);
  d.problem = fmt::format(
      "not certified (avatar): the simulated hand's axes {} in posture {} of {}: {}",
      shakes ? "shake each other" : "follow too slowly", c.avatar.posture + 1, c.avatar.postures,
      shakes ? fmt::format("spectral radius {:.6g} >= 1", c.avatar.radius)
             : fmt::format("a time constant of {:.3g} s, at most {:g} s", c.avatar.slowest_s,
                           AvatarCertificate::kSlowest_s));
  d.remedy = c.avatar.margin > 0.0
                 ? "add armature to the axes that move one another (`wholehand certify` prints how "
                   "much), or "
                   "narrow their range"
                 : "the hand's reduced inertia is singular: check its masses and synergies";
  return d;
}

Diagnostic coupledRefusal(const Certificate& c, Persons persons, const std::string& path) {
  Diagnostic d;
  d.file = path;
  d.key = "k_pm";
  d.problem = fmt::format(
      "not certified (coupled): a passive person and object that link the axes{} need {:.3g} times "
      "the device's damping (at {:.3g} Hz, posture {} of {})",
      persons == Persons::kAny ? ", nonlinear and time-varying ones, too," : "",
      1.0 / c.coupled.margin, c.coupled.frequency_hz, c.coupled.posture, c.avatar.postures);
  d.remedy = "`wholehand certify` prints the nearest gains that pass";
  return d;
}

bool axesHold(const CertificateInput& input) {
  std::vector<AxisCase> held;  // x, y and z are often equal
  for (int i = 0; i < input.device.axisCount(); ++i) {
    const AxisCase c = axisCase(input, i);
    if (std::any_of(held.begin(), held.end(), [&](const AxisCase& h) { return sameCase(h, c); })) {
      continue;
    }
    if (!holds(c)) return false;
    held.push_back(c);
  }
  return true;
}

bool handHolds(const CertificateInput& input) {
  const CoupledCase coupled = coupledCase(input);
  AxisStiffness k_pm(input.device.axisCount());
  for (int i = 0; i < k_pm.size(); ++i) {
    k_pm[i] = input.rendering.axes[i].k_pm;
  }
  const double radius = worstPosture(coupled.inertias, k_pm, input.period_s).radius;
  return radius <= std::exp(-input.period_s / AvatarCertificate::kSlowest_s) &&
         requiredShare(coupled).share <= 1.0;
}

}  // namespace

std::string perUnit(const DeviceAxis& axis, const char* time) {
  return fmt::format("{}{}/{}", axis.effortUnit(), time, axis.positionUnit());
}

std::string stiffnessKey(const DeviceAxis& axis) {
  return axis.kind == AxisKind::kTranslation ? "k_pm_n_m" : "k_pm_nm_rad";
}

std::string armatureKey(const DeviceAxis& axis) {
  return axis.kind == AxisKind::kTranslation ? "armature_kg" : "armature_kg_m2";
}

std::string dampingKey(const DeviceAxis& axis) {
  return axis.kind == AxisKind::kTranslation ? "k_dm_n_s_m" : "k_dm_nm_s_rad";
}

std::vector<std::string> failing(const AxisCertificate& a) {
  std::vector<std::string> out;
  if (!a.passes) out.emplace_back(criterionKey(a.binding));
  for (int i = 0; i <= static_cast<int>(Criterion::kAvatar); ++i) {
    const auto criterion = static_cast<Criterion>(i);
    if (criterion != a.binding && !a.meets(criterion)) out.emplace_back(criterionKey(criterion));
  }
  return out;
}

std::string finding(const AxisCertificate& a) {
  const DeviceAxis& axis = a.axis_case.axis;
  switch (a.binding) {
    case Criterion::kDamping:
      return fmt::format(
          "any passive person and object need {:.3g} {} of device damping (at Φ = {:g}), it has "
          "{:.3g}",
          a.damping_required, perUnit(axis, "·s"), a.damping_required_phi, axis.damping);
    case Criterion::kQuantisation:
      return fmt::format("quantisation allows K_pm up to {:.4g} {}, it is {:.4g}",
                         a.quantisationLimit(), perUnit(axis), a.axis_case.gains.k_pm);
    case Criterion::kWall:
      return findingInWall(a);
    case Criterion::kSlew:
      return fmt::format(
          "at the speed limit its spring needs an effort slew of {:.4g} {}/s, the device follows "
          "{:.4g}",
          a.slew_required, axis.effortUnit(), axis.effort_slew_limit);
    case Criterion::kAvatar:
      return fmt::format("the avatar rings: K_pm over its inertia is {:.4g} 1/s², above 1/T²",
                         a.axis_case.avatarStiffness());
    default:
      break;
  }
  const WorstRadius& worst = a.contacts[static_cast<std::size_t>(a.binding)];
  if (worst.stable()) {
    return fmt::format("a rigid stop allows K_pm up to {:.4g} {}, it is {:.4g}", a.rigid_limit,
                       perUnit(axis), a.axis_case.gains.k_pm);
  }
  return fmt::format("unstable {} at Φ = {:g}: spectral radius {:.6g} > 1", contactWords(a.binding),
                     worst.phi, worst.radius);
}

double bearableWallShare(const AxisCase& c) {
  if (c.walls.empty()) return 1.0;
  const auto bears = [&c](double share) {
    AxisCase softer = c;
    for (WallCase& wall : softer.walls) {
      wall.stiffness *= share;
      wall.damping *= share;
    }
    return holds(softer);
  };
  for (double share = 1.0; share > 0.005; share = std::min(share - 0.01, 0.96 * share)) {
    const double rounded = std::floor(100.0 * share + 1e-9) / 100.0;
    if (bears(rounded)) return rounded;
  }
  return 0.0;
}

Diagnostics refuseUncertified(const CertificateInput& input) {
  if (axesHold(input) && handHolds(input)) return {};
  const Certificate judged = certify(input);
  Diagnostics out;
  for (const AxisCertificate& a : judged.axes) {
    if (!a.passes) out.push_back(refusal(a, input.rendering.path));
  }
  if (!judged.avatar.passes()) out.push_back(avatarRefusal(judged, input.rendering.path));
  if (out.empty() && !(judged.coupled.margin >= 1.0)) {
    out.push_back(coupledRefusal(judged, input.persons, input.rendering.path));
  }
  return out;
}

}  // namespace wholehand
