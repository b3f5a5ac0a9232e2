#pragma once

#include <vector>

namespace wholehand {

/// What was commanded to one axis and what it did, tick by tick. SI; per radian for a rotation.
struct AxisTrace {
  double period_s = 1e-3;
  /// Sent in tick k after position k was read; held until the next [N or N·m].
  std::vector<double> effort;
  std::vector<double> position;  ///< as read [m or rad]
  std::vector<int> posture;      ///< of each tick: 0, 1, 2 .. in the order they were visited
};

}  // namespace wholehand
