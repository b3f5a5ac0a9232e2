#pragma once

#include "assembly/models.hpp"

#include <Eigen/Core>

namespace wholehand {

/// A body to grip, and where.
struct GripTarget {
  int body = -1;                                     ///< of the scene; -1: there is none
  Eigen::Vector3d grip_m = Eigen::Vector3d::Zero();  ///< world
};

/// The first dispenser that the exercise tells of.
[[nodiscard]] GripTarget firstDispenser(const Models& models);

/// The first body of the scene that can be moved, or the first of all; at its centre of mass.
[[nodiscard]] GripTarget firstBody(const Models& models);

}  // namespace wholehand
