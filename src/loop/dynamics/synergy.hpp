#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/hand_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wholehand {

/// The synergy map from the coordinates that a person drives to the joints of the hand, θ = θ₀ + G
/// q_s. Real-time safe except the constructor.
class Synergy {
 public:
  /// @pre every axis drives a joint (assembleHand() checks it)
  explicit Synergy(const HandModel& hand);

  /// θ = θ₀ + G q_s
  WHOLEHAND_RT void expand(const AxisPosition& q_s, JointPosition& theta) const noexcept {
    theta = theta0_;
    for (int i = 0; i < forward_count_; ++i) {
      theta[forward_[i].joint] += forward_[i].value * q_s[forward_[i].axis];
    }
  }
  /// θ̇ = G q̇_s; the same map serves velocities and impulses.
  WHOLEHAND_RT void expandRate(const double* axes, double* joints) const noexcept {
    std::fill_n(joints, joints_, 0.0);
    for (int i = 0; i < forward_count_; ++i) {
      joints[forward_[i].joint] += forward_[i].value * axes[forward_[i].axis];
    }
  }

 private:
  struct Entry {
    int joint = 0;
    int axis = 0;
    double value = 0.0;
  };
  JointPosition theta0_;
  int joints_;
  std::array<Entry, kMaxJoints * kMaxAxes> forward_;
  int forward_count_ = 0;
};

/// First joint driven by this axis alone; -1: none.
[[nodiscard]] int leadingJoint(const HandModel& hand, int axis);

}  // namespace wholehand
