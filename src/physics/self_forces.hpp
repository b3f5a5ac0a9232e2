#pragma once

#include "core/axis_array.hpp"
#include "core/geometry.hpp"

#include <array>

namespace wholehand {

/// The most touches of a hand with itself that are told; further ones act but are not shown.
inline constexpr int kMaxSelfForces = 64;

/// A point where two capsules of the hand touch, after a step. World frame.
struct SelfForce {
  int capsule_a = -1, capsule_b = -1;  ///< indices into HandModel::capsules
  Vec3 point_m;
  Vec3 normal;              ///< unit, from b to a
  Vec3 force_n;             ///< on a, normal and friction together; b feels the opposite
  double distance_m = 0.0;  ///< before the step; negative when the surfaces overlap
};

/// What the hand did to itself in the last step.
struct SelfForces {
  int count = 0;
  std::array<SelfForce, kMaxSelfForces> touches{};
  AxisEffort joint_ends;  ///< of joints at an end of their range, on every axis [N or N·m]
};

}  // namespace wholehand
