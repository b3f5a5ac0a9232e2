#pragma once

#include "model/anthropometry.hpp"
#include "model/mass_properties.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Density of flesh and bone together [kg/m³].
inline constexpr double kHandDensity_kg_m3 = 1100.0;

/// A capsule of uniform density, in closed form: a cylinder and two half balls.
[[nodiscard]] MassProperties capsuleMass(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m,
                                         double radius_m, double density_kg_m3);

/// Capsules that overlap, each point counted once, over a grid of the given step. Capsules without
/// mass are left out.
[[nodiscard]] MassProperties unionMass(const std::vector<PlacedCapsule>& capsules,
                                       double density_kg_m3, double step_m);

}  // namespace wholehand
