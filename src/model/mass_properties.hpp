#pragma once

#include "core/geometry.hpp"
#include "model/scene_model.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace wholehand {

/// Mass, centre of mass and inertia of a rigid body, all in one frame.
struct MassProperties {
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about the centre of mass
};

/// Of the shapes at one uniform density that gives them this mass together [kg]. Where shapes of
/// one body overlap, the common part counts once for each.
[[nodiscard]] MassProperties uniformDensity(const std::vector<Shape>& shapes, double mass_kg);

/// Of two bodies welded together (parallel axes); both in the same frame.
[[nodiscard]] MassProperties combined(const MassProperties& a, const MassProperties& b);

/// The same body seen from an outer frame: `inner_in_outer` places its frame there.
[[nodiscard]] MassProperties moved(const MassProperties& m, const Pose& inner_in_outer);

/// Why no rigid body has this inertia about its centre of mass; empty when one can. Its principal
/// moments must be positive and none larger than the sum of the other two.
[[nodiscard]] std::string inertiaFault(const Eigen::Matrix3d& inertia_kg_m2);

}  // namespace wholehand
