#pragma once

#include "core/axis_array.hpp"
#include "core/geometry.hpp"

#include <array>

namespace wholehand {

/// Limit of reported self-contacts; further ones act, but are not reported.
inline constexpr int kMaxSelfForces = 64;

/// Self-contact point of two capsules after a step. World frame.
struct SelfForce {
  int capsule_a = -1, capsule_b = -1;  ///< indices into HandModel::capsules
  Vec3 point_m;
  Vec3 normal;              ///< unit, from b to a
  Vec3 force_n;             ///< on a, normal and friction; b gets the opposite
  double distance_m = 0.0;  ///< before the step; negative when the surfaces overlap
};

/// Self-contact forces of the last step.
struct SelfForces {
  int count = 0;
  std::array<SelfForce, kMaxSelfForces> touches{};
  AxisEffort joint_ends;  ///< efforts of joints at the end of their range, per axis [N or N·m]
};

}  // namespace wholehand
