#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/hand_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wholehand {

/// The synergy map between the few coordinates a person drives and the many joints of the hand,
/// θ = θ₀ + G q_s, and back by least squares, q_s = (GᵀG)⁻¹ Gᵀ (θ − θ₀). Real-time safe but for
/// construction.
class Synergy {
 public:
  /// @pre every axis drives a joint (assembleHand() sees to it)
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
  /// q_s of the nearest joint position on the synergy.
  WHOLEHAND_RT void reduce(const JointPosition& theta, AxisPosition& q_s) const noexcept {
    q_s = AxisPosition(axes_);
    for (int i = 0; i < back_count_; ++i) {
      const Entry& e = back_[i];
      q_s[e.axis] += e.value * (theta[e.joint] - theta0_[e.joint]);
    }
  }
  /// q̇_s of the nearest joint velocity on the synergy.
  WHOLEHAND_RT void reduceRate(const double* joints, double* axes) const noexcept {
    std::fill_n(axes, axes_, 0.0);
    for (int i = 0; i < back_count_; ++i) {
      axes[back_[i].axis] += back_[i].value * joints[back_[i].joint];
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
  int axes_;
  std::array<Entry, kMaxJoints * kMaxAxes> forward_;
  std::array<Entry, kMaxJoints * kMaxAxes> back_;
  int forward_count_ = 0;
  int back_count_ = 0;
};

}  // namespace wholehand
