#pragma once

#include "model/axis_keys.hpp"

/// Quantities of a person on an axis and in links, as named in a patient file.
namespace wholehand {

// Tip values convert to joint values by the lever arm squared: one factor for the force, one for
// the path. In links, by the lever arms of both axes.
inline constexpr AxisQuantity kPersonMass{"mass_kg", "inertia_kg_m2", "mass_tip_kg", 2, 0.0, 100.0};
inline constexpr AxisQuantity kPersonDamping{
    "damping_n_s_m", "damping_nm_s_rad", "damping_tip_n_s_m", 2, 0.0, 1e4};
inline constexpr AxisQuantity kPersonStiffness{
    "stiffness_n_m", "stiffness_nm_rad", "stiffness_tip_n_m", 2, 0.0, 1e6};

}  // namespace wholehand
