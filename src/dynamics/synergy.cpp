#include "dynamics/synergy.hpp"

namespace wholehand {

Synergy::Synergy(const HandModel& hand) : theta0_(hand.theta0), joints_(hand.joint_count) {
  for (int j = 0; j < hand.joint_count; ++j) {
    for (int a = 0; a < hand.axis_count; ++a) {
      const double value = hand.synergy(j, a);
      if (value != 0.0) forward_[forward_count_++] = {j, a, value};
    }
  }
}

}  // namespace wholehand
