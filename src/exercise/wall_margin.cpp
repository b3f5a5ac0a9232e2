#include "exercise/wall_margin.hpp"

#include "control/passivity.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace wholehand {
namespace {

constexpr std::array<double, 5> kShares = {0.0, 0.25, 0.5, 0.75, 1.0};

bool stable(const AxisLoop& loop) {
  for (const ContactCase contact : {ContactCase::kFree, ContactCase::kRigid}) {
    // A rigid drift is an eigenvalue of exactly 1, here with its rounding.
    if (!(spectralRadius(closedLoopMatrix(loop, contact)) <= 1.0 + 1e-7)) return false;
  }
  return true;
}

}  // namespace

double wallMargin(const AxisLoop& loop, double stiffness, double damping) {
  double worst = std::numeric_limits<double>::infinity();
  for (const double alpha : kShares) {
    for (const double phi : kShares) {
      AxisLoop walled = loop;
      walled.phi_k_dm = phi * loop.phi_k_dm;
      walled.wall_stiffness = alpha * stiffness;
      walled.wall_damping = alpha * damping;
      if (!stable(walled)) return 0.0;
      const double required = requiredDamping(walled);
      if (required > 0.0) worst = std::min(worst, loop.damping / required);
    }
  }
  return worst;
}

}  // namespace wholehand
