#include "control/z_width.hpp"

#include "control/certificate/gain_search.hpp"
#include "control/passivity.hpp"

#include <algorithm>

namespace wholehand {

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
