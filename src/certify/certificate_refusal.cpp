#include "certify/certificate_refusal.hpp"

#include "certify/passivity.hpp"
#include "certify/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace wholehand {
namespace {

/// Number of frequencies in a search; its result is verified with kAllFrequencies.
constexpr int kSearchFrequencies = 400;
constexpr int kAllFrequencies = 4000;
constexpr std::array<double, 8> kDampingShares = {1.0, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.0};

AxisCase withStiffness(AxisCase c, double k_pm) {
  c.gains.k_pm = k_pm;
  return c;
}

bool rings(const AxisCase& c) {
  return c.avatarStiffness() * c.period_s * c.period_s > 1.0;
}

/// True when the device damping covers b_min. b_min is convex in Φ and in a wall's α, as a maximum
/// over frequencies of functions that are affine in both, so its largest value lies at a corner.
bool dampedEnough(const AxisCase& c, int frequencies) {
  if (rings(c)) return false;
  std::vector<WallCase> walls = c.walls;
  walls.push_back({});
  return std::all_of(walls.begin(), walls.end(), [&](const WallCase& wall) {
    return requiredDamping(c.loopIn(wall, 1.0, 0.0), frequencies) <= c.axis.damping &&
           requiredDamping(c.loopIn(wall, 1.0, 1.0), frequencies) <= c.axis.damping;
  });
}

bool stableInEveryContact(const AxisCase& c) {
  for (int i = 0; i < kContactCriteria; ++i) {
    if (!worstContact(c, static_cast<Criterion>(i)).stable()) return false;
  }
  return std::all_of(c.walls.begin(), c.walls.end(),
                     [&](const WallCase& wall) { return certifyWall(c, wall).worst.stable(); });
}

/// K_pm that quantisation admits together with the stiffest wall. The search begins there.
double quantisationLeaves(const AxisCase& c) {
  double stiffest = 0.0;
  for (const WallCase& wall : c.walls) stiffest = std::max(stiffest, wall.stiffness);
  return quantisationLimit(c) - stiffest;
}

bool followed(const AxisCase& c) {
  return !(c.axis.effort_slew_limit > 0.0) || requiredSlew(c) <= c.axis.effort_slew_limit;
}

/// Largest K_pm by absolute stability alone, not rounded.
double searched(const AxisCase& c, double most) {
  const double start = std::min(most, quantisationLeaves(c));
  const auto passes = [&](double k_pm) {
    const AxisCase tried = withStiffness(c, k_pm);
    return followed(tried) && dampedEnough(tried, kSearchFrequencies);
  };
  if (start > 0.0 && passes(start)) return start;
  return largestAllowed(start, passes);
}

double verified(const AxisCase& c, double k_pm) {
  for (int attempt = 0; attempt < 100 && k_pm > 0.0; ++attempt) {
    k_pm = roundedDown(k_pm);
    const AxisCase tried = withStiffness(c, k_pm);
    if (holds(tried)) return k_pm;
    k_pm *= 0.999;
  }
  return 0.0;
}

double roundedUp(double value) {
  const double below = roundedDown(value);
  return below < value ? roundedDown(1.0101 * value) : below;
}

AxisStiffness stiffnessOf(const CertificateInput& input) {
  AxisStiffness k_pm(input.device.axisCount());
  for (int i = 0; i < k_pm.size(); ++i) {
    k_pm[i] = input.rendering.axes[i].k_pm;
  }
  return k_pm;
}

/// Raises the armature of axes that oscillate. If the coupled axes are unstable, raises it on all
/// axes by the same share of their inertia, or by up to three times that share if linked persons
/// and objects then pass.
void raiseArmature(CertificateInput& input, const Certificate& judged) {
  const double ringing = 1.0 / (input.period_s * input.period_s);
  const CertificateInput given = input;
  std::optional<CertificateInput> base;
  double most = 100.0;
  for (double more = judged.avatar.radius < 1.0 ? 0.0 : 0.01; more < most; more *= 1.2) {
    for (std::size_t i = 0; i < judged.axes.size(); ++i) {
      const AxisCase& c = judged.axes[i].axis_case;
      const double inertia = c.inertia + c.armature();
      const double wanted = std::max((1.0 + more) * inertia, c.gains.k_pm / ringing);
      if (wanted > inertia) input.rendering.axes[i].armature = roundedUp(wanted - c.inertia);
    }
    if (more == 0.0) return;
    const CoupledCase coupled = coupledCase(input);
    if (!(worstPosture(coupled.inertias, stiffnessOf(input), input.period_s).radius < 1.0)) {
      continue;
    }
    if (requiredShare(coupled).share <= 1.0) return;
    if (!base) {
      base = input;
      most = 3.0 * more;
    }
  }
  input = base.value_or(given);
}

/// Scales every K_pm by one factor (three digits) until the coupled criterion passes.
bool softenForCoupled(CertificateInput& input) {
  const CertificateInput given = input;
  const auto soften = [&](double factor) {
    input = given;
    for (AxisRendering& axis : input.rendering.axes) axis.k_pm = roundedDown(factor * axis.k_pm);
  };
  if (requiredShare(coupledCase(input)).share <= 1.0) return true;
  const double factor = largestAllowed(1.0, [&](double f) {
    soften(f);
    return requiredShare(coupledCase(input)).share <= 1.0;
  });
  soften(factor);
  return factor > 0.0;
}

}  // namespace

CertificateInput withGains(CertificateInput input, const std::vector<NearestGains>& nearest) {
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    input.rendering.axes[i].k_pm = nearest[i].k_pm;
    input.rendering.axes[i].k_dm = nearest[i].k_dm;
    input.rendering.axes[i].armature = nearest[i].armature;
  }
  return input;
}

bool holds(const AxisCase& c) {
  return c.gains.k_pm <= quantisationLeaves(c) && followed(c) && dampedEnough(c, kAllFrequencies) &&
         stableInEveryContact(c);
}

/// Lowers K_pm. Also lowers K_dm if that at least doubles the remaining stiffness.
NearestGains nearestOfAxis(AxisCase c) {
  const double present = c.gains.k_pm, damping = c.gains.k_dm;
  std::vector<NearestGains> found;
  double most = 0.0;
  for (const double share : kDampingShares) {
    c.gains.k_dm = share == 1.0 ? damping : roundedDown(share * damping);
    found.push_back({largestStiffness(c, present), c.gains.k_dm, c.gains.armature});
    most = std::max(most, found.back().k_pm);
    if (damping == 0.0 || found.back().k_pm >= 0.5 * present) break;
  }
  return *std::find_if(found.begin(), found.end(),
                       [&](const NearestGains& g) { return g.k_pm >= 0.5 * most; });
}

double largestStiffness(const AxisCase& c, double most) {
  return verified(c, searched(c, most));
}

AxisAdvice advise(const AxisCase& c) {
  AxisAdvice out;
  constexpr double kAny = 1e9;
  for (std::size_t i = 0; i < kAdmittedRatesHz.size(); ++i) {
    AxisCase faster = c;
    faster.period_s = 1.0 / kAdmittedRatesHz[i];
    faster.axis.effort_slew_limit = 0.0;  // a setting of the device file, not a limit of the loop
    out.admitted_k_pm[i] = largestStiffness(faster, kAny);
  }
  AxisCase best = c;
  double most = 0.0;
  for (int step = 0; step <= 20; ++step) {
    AxisCase tried = c;
    tried.gains.gamma = step / 20.0;
    tried.axis.effort_slew_limit = 0.0;
    const double k_pm = searched(tried, kAny);
    if (k_pm > most) {
      most = k_pm;
      best = tried;
    }
  }
  out.best_gamma = best.gains.gamma;
  out.best_gamma_k_pm = verified(best, most);
  return out;
}

std::optional<std::vector<NearestGains>> nearestGains(const CertificateInput& input,
                                                      const Certificate& judged) {
  CertificateInput tried = input;
  raiseArmature(tried, judged);
  std::vector<NearestGains> nearest;
  for (int i = 0; i < tried.device.axisCount(); ++i) {
    const AxisCase c = axisCase(tried, i);
    const AxisCase& before = judged.axes[i].axis_case;
    const bool untouched = c.gains.armature == before.gains.armature;
    if (untouched && judged.axes[i].passes) {
      nearest.push_back({c.gains.k_pm, c.gains.k_dm, c.gains.armature});
      continue;
    }
    nearest.push_back(nearestOfAxis(c));
    if (!(nearest.back().k_pm > 0.0)) return std::nullopt;
  }
  tried = withGains(input, nearest);
  if (!softenForCoupled(tried) || !certify(tried).certified) return std::nullopt;
  for (std::size_t i = 0; i < nearest.size(); ++i) nearest[i].k_pm = tried.rendering.axes[i].k_pm;
  return nearest;
}

bool sameCase(const AxisCase& a, const AxisCase& b) {
  const auto key = [](const AxisCase& c) {
    return std::tuple(c.axis.kind, c.axis.mass, c.axis.damping, c.axis.coulomb, c.axis.encoder_step,
                      c.axis.lever_arm_m, c.delay_ticks, c.period_s, c.gains.k_pm, c.gains.k_dm,
                      c.gains.gamma, c.gains.velocity_filter_hz, c.gains.armature,
                      c.axis.speed_limit, c.axis.effort_slew_limit);
  };
  // The tolerance covers reflected masses along x, y and z, which differ by millionths.
  return a.walls == b.walls && key(a) == key(b) &&
         std::abs(a.inertia - b.inertia) <= 1e-4 * a.inertia;
}

std::vector<ZWidthPoint> zWidth(const AxisCase& c, int points) {
  const double end = c.gains.k_dm > 0.0 ? 2.0 * c.gains.k_dm : c.axis.damping;
  std::vector<ZWidthPoint> out;
  for (int i = 0; i < points; ++i) {
    AxisCase at = c;
    at.gains.k_dm = end * i / (points - 1);
    const auto loop = [&at](double k_pm) {
      at.gains.k_pm = k_pm;
      return at.loop(1.0);
    };
    // Start far above every curve; the search steps down from it.
    const double most = 20.0 * std::max(2.0 * c.axis.damping / c.period_s, c.gains.k_pm);
    ZWidthPoint point{at.gains.k_dm, 0.0, 0.0, 0.0};
    point.rigid = largestAllowed(most, [&](double k_pm) {
      return spectralRadius(closedLoopMatrix(loop(k_pm), ContactCase::kRigid)) <= 1.0 + 1e-7;
    });
    point.passive = largestAllowed(
        most, [&](double k_pm) { return requiredDamping(loop(k_pm), 300) <= c.axis.damping; });
    point.walled = point.passive;
    for (const WallCase& wall : c.walls) {
      point.walled =
          std::min(point.walled, largestAllowed(most, [&](double k_pm) {
                     at.gains.k_pm = k_pm;
                     return requiredDamping(at.loopIn(wall, 1.0, 1.0), 300) <= c.axis.damping;
                   }));
    }
    out.push_back(point);
  }
  return out;
}

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

/// "unstable against a rigid stop at Φ = 0: spectral radius 1.01 > 1; ". It precedes the binding
/// criterion because instability is worse. Empty if no contact is unstable or the unstable one
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
  return keyFault(path, a.axis_case.axis.name + "." + stiffnessKey(a.axis_case.axis),
                  fmt::format("{:.6g} {}", a.axis_case.gains.k_pm, perUnit(a.axis_case.axis)),
                  fmt::format("not certified ({}): {}", fmt::join(failing(a), ", "),
                              instability(a) + finding(a)),
                  remedy(a));
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
  std::vector<AxisCase> held;  // cases that passed; x, y and z are often equal
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

bool isCertified(const CertificateInput& input) {
  return axesHold(input) && handHolds(input);
}

Diagnostics refuseUncertified(const CertificateInput& input) {
  if (isCertified(input)) return {};
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
