#pragma once

#include "core/geometry.hpp"
#include "model/scene/scene_model.hpp"

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

/// Mass properties of shapes with a common density and this total mass [kg]. Overlapping volume
/// counts once per shape.
[[nodiscard]] MassProperties uniformDensity(const std::vector<Shape>& shapes, double mass_kg);

/// Mass properties of two rigidly joined bodies (parallel axes); both in the same frame.
[[nodiscard]] MassProperties combined(const MassProperties& a, const MassProperties& b);

/// Transforms mass properties into an outer frame: `inner_in_outer` is the pose of the inner one.
[[nodiscard]] MassProperties moved(const MassProperties& m, const Pose& inner_in_outer);

/// Reason why an inertia about the centre of mass is impossible, or empty. Principal moments must
/// be positive, and none larger than the sum of the other two.
[[nodiscard]] std::string inertiaFault(const Eigen::Matrix3d& inertia_kg_m2);

}  // namespace wholehand
