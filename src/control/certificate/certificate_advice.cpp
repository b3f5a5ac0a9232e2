#include "control/certificate/certificate_advice.hpp"

#include "control/passivity.hpp"
#include "control/stability.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace wholehand {
namespace {

/// Frequencies of a search; its result is verified with all frequencies.
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

/// b_min is convex in Φ and in a wall's α: it is a maximum over frequencies of functions that are
/// affine in both. Its largest value lies at a corner.
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

/// K_pm admitted by quantisation beside the stiffest wall. The search begins there.
double quantisationLeaves(const AxisCase& c) {
  double stiffest = 0.0;
  for (const WallCase& wall : c.walls) stiffest = std::max(stiffest, wall.stiffness);
  return quantisationLimit(c) - stiffest;
}

bool followed(const AxisCase& c) {
  return !(c.axis.effort_slew_limit > 0.0) || requiredSlew(c) <= c.axis.effort_slew_limit;
}

/// K_pm by absolute stability alone, not rounded.
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

/// Raises the armature where an axis rings. Where the axes are unstable together, raises it on all
/// by the same share of their inertia; up to three times that share where linked persons and
/// objects then pass.
void raiseArmature(CertificateInput& input, const Certificate& judged) {
  const double ringing = 1.0 / (input.period_s * input.period_s);
  const CertificateInput given = input;
  std::optional<CertificateInput> calm;
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
    if (!calm) {
      calm = input;
      most = 3.0 * more;
    }
  }
  input = calm.value_or(given);
}

/// Scales every K_pm by one factor, three digits, until the coupled criterion passes.
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

/// Lowers K_pm. Lowers K_dm only where that at least doubles the remaining stiffness.
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
    faster.axis.effort_slew_limit = 0.0;  // a setting of the device file, no bound of the loop
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
  // Reflected masses along x, y and z differ by millionths.
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
    // Far above every curve; the search steps down to it.
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

}  // namespace wholehand
