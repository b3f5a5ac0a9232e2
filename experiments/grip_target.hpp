#pragma once

#include "rig/models.hpp"

#include <Eigen/Core>

namespace wholehand {

/// A body to grip, and the grip position.
struct GripTarget {
  int body = -1;                                     ///< scene body; -1: none
  Eigen::Vector3d grip_m = Eigen::Vector3d::Zero();  ///< world
};

/// The exercise's first dispenser.
[[nodiscard]] GripTarget firstDispenser(const Models& models);

/// The scene's first movable body, else its first body; gripped at its centre of mass.
[[nodiscard]] GripTarget firstBody(const Models& models);

}  // namespace wholehand
