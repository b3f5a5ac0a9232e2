#include "loop/dynamics/synergy.hpp"

namespace wholehand {

Synergy::Synergy(const HandModel& hand) : theta0_(hand.theta0), joints_(hand.joint_count) {
  for (int j = 0; j < hand.joint_count; ++j) {
    for (int a = 0; a < hand.axis_count; ++a) {
      const double value = hand.synergy(j, a);
      if (value != 0.0) forward_[forward_count_++] = {j, a, value};
    }
  }
}

int leadingJoint(const HandModel& hand, int axis) {
  for (int j = 0; j < hand.joint_count; ++j) {
    bool alone = hand.synergy(j, axis) != 0.0;
    for (int b = 0; b < hand.axis_count; ++b) {
      alone = alone && (b == axis || hand.synergy(j, b) == 0.0);
    }
    if (alone) return j;
  }
  return -1;
}

}  // namespace wholehand
