#pragma once

namespace wholehand::mujoco {

/// Settings of MuJoCo's contact solver; ADR 39 explains the differences from stock.
struct SolverSettings {
  int iterations = 50;          ///< limit of Newton iterations; 2 to 8 are needed
  double tolerance = 1e-10;     ///< scaled gradient at which Newton's method stops
  double impedance = 0.9999;    ///< fraction of the target velocity change that a contact achieves
  double friction_ratio = 1e3;  ///< MuJoCo's impratio: stiffness of friction relative to the normal
  double recovery = 0.05;       ///< fraction of a penetration removed per step
  double foresight_m = 2e-3;    ///< surfaces nearer than this get a contact before they touch
  double spinning_friction_m = 0.002;  ///< torque about the normal per normal force, for soft
                                       ///< finger pads
  int most_contacts = 256;             ///< limit of all contacts; more are dropped and counted
};

}  // namespace wholehand::mujoco
