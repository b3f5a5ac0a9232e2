#pragma once

namespace wholehand::bullet {

/// Settings of Bullet's contact solver; ADR 3 explains the differences from stock.
struct SolverSettings {
  int iterations = 50;        ///< per step; 20 let one grasp slide, 100 bring slip to 0.05 mm
  int far_iterations = 10;    ///< for contacts of bodies that the hand does not touch
  double contact_erp = 0.05;  ///< fraction of a penetration removed per step
  double friction_anchor_erp = 0.2;  ///< fraction of a tangential drift removed per step
  double penetration_slop_m = 1e-5;
  double warm_start = 0.996;           ///< fraction of the last step's impulses to start from
  double spinning_friction_m = 0.002;  ///< torque about the normal per normal force, for soft
                                       ///< finger pads
};

}  // namespace wholehand::bullet
