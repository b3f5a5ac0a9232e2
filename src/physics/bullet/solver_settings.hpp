#pragma once

namespace wholehand::bullet {

/// How Bullet's contacts are solved; why these differ from stock is written in ADR 3.
struct SolverSettings {
  int iterations = 50;        ///< per step; 20 let one grasp slide, 100 bring slip to 0.05 mm
  double contact_erp = 0.05;  ///< share of a penetration removed per step
  double friction_anchor_erp = 0.2;  ///< share of a tangential drift removed per step
  double penetration_slop_m = 1e-5;
  double warm_start = 0.996;           ///< share of last step's impulses to start from
  double spinning_friction_m = 0.002;  ///< torque about the normal per normal force; the soft pad
};

}  // namespace wholehand::bullet
