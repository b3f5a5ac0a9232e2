#include "control/virtual_wall.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

double wallEffort(const VirtualWall& wall, double position, double velocity,
                  double alpha) noexcept {
  const double side = wall.closing < 0.0 ? -1.0 : 1.0;
  const double depth = side * (position - wall.position);
  const double push = wall.stiffness * depth + wall.damping * side * velocity;
  // The comparisons are false for NaN, so NaN gives no effort.
  if (!(depth > 0.0) || !(push > 0.0) || !(alpha > 0.0) || !(wall.effort_cap > 0.0)) return 0.0;
  if (!std::isfinite(depth) || !std::isfinite(push)) return 0.0;
  return -side * std::min(alpha, 1.0) * std::min(push, wall.effort_cap);
}

}  // namespace wholehand
