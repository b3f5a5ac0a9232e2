#pragma once

#include "loop/physics/bullet/cone_newton.hpp"

namespace wholehand::bullet {

inline constexpr int kLeastFarSweeps = 10, kMostFarSweeps = 200, kFarBudget = 1000;
/// Where the hand touches one of two bodies that lie on each other, one ten times as heavy: with 50
/// sweeps a grasped cylinder of 1 g with 0.4 kg on it slipped by 0.75 mm.
inline constexpr int kUnevenSweeps = 200;

/// Settings of Bullet's contact solver; ADR 3 explains the differences from stock.
struct SolverSettings {
  int iterations = 50;   ///< per step; 20 let one grasp slide
  bool at_once = false;  ///< the hand's contacts by Newton's method where that applies (ADR 39)
  NewtonSettings newton;
  /// Contacts of bodies that the hand does not touch are swept until an impulse changes by less
  /// than this share of the largest, within a budget of groups of four contacts: kFarBudget.
  double far_tolerance = 1e-4;
  double body_warm_start = 0.97;  ///< fraction of the last step's impulses between bodies
  double contact_erp = 0.05;      ///< fraction of a penetration removed per step
  double body_push_m_s = 0.02;    ///< the fastest that it moves two bodies apart
  /// Of a contact between hand and body in its normal direction. Row's softness:
  /// R = contact_erp / (contact_stiffness h²), so that λ = h · stiffness · depth at rest.
  double contact_stiffness_n_m = 2.5e6;
  double friction_anchor_erp = 0.2;  ///< fraction of a tangential drift removed per step
  double penetration_slop_m = 1e-5;
  double warm_start = 0.99995;  ///< fraction of the last step's impulses of the hand to start from
  /// The same of normal impulses against what no contact moves: of two that press the hand from
  /// opposite sides, the impulses add up in each sweep.
  double wall_warm_start = 0.996;
  double self_warm_start = 0.996;      ///< the same of touches within the hand and of joint ends
  double spinning_friction_m = 0.002;  ///< torque about the normal per normal force, for soft
                                       ///< finger pads
};

}  // namespace wholehand::bullet
