#pragma once

#include "model/hand/anthropometry.hpp"
#include "model/mass_properties.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Mean density of flesh and bone [kg/m³].
inline constexpr double kHandDensity_kg_m3 = 1100.0;

/// Mass properties of a capsule of uniform density, in closed form: a cylinder and two hemispheres.
[[nodiscard]] MassProperties capsuleMass(const Eigen::Vector3d& a_m, const Eigen::Vector3d& b_m,
                                         double radius_m, double density_kg_m3);

/// Mass properties of the union of overlapping capsules, on a grid of the given step. Capsules
/// without mass are skipped.
[[nodiscard]] MassProperties unionMass(const std::vector<PlacedCapsule>& capsules,
                                       double density_kg_m3, double step_m);

}  // namespace wholehand
