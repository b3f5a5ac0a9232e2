#pragma once

namespace wholehand::mujoco {

/// How MuJoCo's contacts are solved; why these differ from stock is written in ADR 39.
struct SolverSettings {
  int iterations = 50;          ///< of Newton's method at most; it takes 2 to 8
  double tolerance = 1e-10;     ///< scaled gradient at which Newton's method ends
  double impedance = 0.9999;    ///< share of the wanted change of velocity that a contact gives
  double friction_ratio = 1e3;  ///< MuJoCo's impratio: how much firmer friction is than the normal
  double recovery = 0.05;       ///< share of a penetration removed per step
  double foresight_m = 2e-3;    ///< surfaces nearer than this are foreseen
  double spinning_friction_m = 0.002;  ///< torque about the normal per normal force; the soft pad
  int most_contacts = 256;             ///< of all kinds; further ones are dropped and counted
};

}  // namespace wholehand::mujoco
