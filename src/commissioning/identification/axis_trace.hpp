#pragma once

#include <vector>

namespace wholehand {

/// Commands to one axis and its positions, tick by tick. SI; per radian for a rotation.
struct AxisTrace {
  double period_s = 1e-3;
  /// Sent in tick k after position k was read; held until the next tick [N or N·m].
  std::vector<double> effort;
  std::vector<double> position;  ///< as read [m or rad]
  std::vector<int> posture;      ///< posture of each tick: 0, 1, 2 .. in the order visited
};

}  // namespace wholehand
