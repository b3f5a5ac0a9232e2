#include "control/certificate/certificate.hpp"
#include "control/certificate/gain_search.hpp"
#include "control/passivity.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr int kAlphaSteps = 4;

WorstRadius worstInWall(const AxisCase& c, const WallCase& wall) {
  WorstRadius worst;
  for (int share = 1; share <= kAlphaSteps; ++share) {
    const double alpha = static_cast<double>(share) / kAlphaSteps;
    for (int i = 0; i < kContactCriteria; ++i) {
      const WorstRadius found = worstContact(c, static_cast<Criterion>(i), wall, alpha);
      if (!(found.radius <= worst.radius)) worst = found;
    }
  }
  return worst;
}

}  // namespace

LargestDamping largestRequiredDamping(const AxisCase& c, const WallCase& wall, double alpha) {
  LargestDamping most{-std::numeric_limits<double>::infinity(), 0.0};
  for (int i = 0; i <= kCertificatePhiSteps; ++i) {
    const double phi = static_cast<double>(i) / kCertificatePhiSteps;
    const double required = requiredDamping(c.loopIn(wall, alpha, phi));
    if (required > most.damping) most = {required, phi};
  }
  return most;
}

WallCertificate certifyWall(const AxisCase& c, const WallCase& wall) {
  WallCertificate out;
  out.wall = wall;
  const LargestDamping needed = largestRequiredDamping(c, wall, 1.0);
  out.damping_required = needed.damping;
  out.damping_required_phi = needed.phi;
  out.worst = worstInWall(c, wall);
  // Quantisation acts on coupling spring and wall spring at once.
  out.margin = quantisationLimit(c) / (c.gains.k_pm + wall.stiffness);
  if (needed.damping > 0.0) out.margin = std::min(out.margin, c.axis.damping / needed.damping);
  if (!out.worst.stable()) {
    const double share = largestAllowed(1.0, [&](double s) {
      return worstInWall(c, {s * wall.stiffness, s * wall.damping}).stable();
    });
    out.margin = std::min(out.margin, share);
  }
  return out;
}

double requiredSlew(const AxisCase& c) {
  double most = 0.0;
  std::vector<WallCase> walls = c.walls;
  walls.push_back({});
  for (const WallCase& wall : walls) {
    const AxisLoop l = c.loopIn(wall, 1.0, 1.0);
    const double stiffness = l.k_pm + l.wall_stiffness;
    const double reciprocal = l.gamma * l.k_pm * l.k_ds_per_s / l.k_ps_per_s2;
    const double damping = reciprocal + l.phi_k_dm + l.wall_damping;
    const double rate_per_s = std::sqrt(stiffness / l.mass) + (damping + l.damping) / l.mass;
    most = std::max(most, c.axis.speed_limit * (stiffness + damping * rate_per_s));
  }
  return most;
}

}  // namespace wholehand
