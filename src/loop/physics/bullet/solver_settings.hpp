#pragma once

#include "loop/physics/bullet/cone_newton.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {

/// Bounds of the number of sweeps over bodies that the hand does not touch. kFarBudget bounds the
/// number of sweeps times the number of groups of contacts.
inline constexpr int kLeastFarSweeps = 10, kMostFarSweeps = 200, kFarBudget = 1000;
/// Number of sweeps when the hand touches one of two bodies that lie on each other and one is at
/// least ten times as heavy. With 50 sweeps a grasped cylinder of 1 g with 0.4 kg on it slipped by
/// 0.75 mm.
inline constexpr int kUnevenSweeps = 200;

/// Settings of Bullet's contact solver; ADR 3 explains the differences from stock.
struct SolverSettings {
  int iterations = 50;  ///< sweeps per step of at most 2 ms; with 20 a grasp slid
  /// True: solves the hand's contacts by Newton's method where possible (ADR 39).
  bool at_once = false;
  /// True: bodies that have been still for a time rest and are no longer computed.
  bool lets_rest = true;
  NewtonSettings newton;
  /// Contacts of bodies that the hand does not touch are swept until no impulse changes by more
  /// than this share of the largest one. kFarBudget limits the sweeps times the number of groups of
  /// four contacts.
  double far_tolerance = 1e-4;
  double body_warm_start = 0.97;  ///< fraction of the last step's impulses between bodies
  double contact_erp = 0.05;      ///< fraction of a penetration removed per step
  double body_push_m_s = 0.02;    ///< largest speed at which the correction moves two bodies apart
  /// Stiffness of a contact between hand and body in its normal direction. The softness of the row
  /// is R = contact_erp / (contact_stiffness h²), so that λ = h · stiffness · depth at rest.
  double contact_stiffness_n_m = 2.5e6;
  double friction_anchor_erp = 0.2;  ///< fraction of a tangential drift removed per step
  double penetration_slop_m = 1e-5;
  /// Fraction of the last step's impulses of the hand that the next step starts from.
  double warm_start = 0.99995;
  /// The same for normal impulses against bodies that cannot move. If two of them press the hand
  /// from opposite sides, their impulses would otherwise grow with each sweep.
  double wall_warm_start = 0.996;
  double self_warm_start = 0.996;  ///< the same for self-contacts of the hand and for joint ends
  double spinning_friction_m = 0.002;  ///< torque about the normal per normal force, for soft
                                       ///< finger pads
};

/// Sweeps over the hand's contacts in a step. Two opposed contacts settle by the ratio of their
/// softness, which falls with 1/T², to the mobility between them. So from 2 ms on the number grows
/// with T²: with 50 at 200 Hz a thumb between a jaw and its own joint's end drifts.
[[nodiscard]] inline int sweepsOfHand(const SolverSettings& settings, double step_s) noexcept {
  constexpr double kEnough_s = 2e-3;
  const double longer = std::max(1.0, step_s / kEnough_s);
  return static_cast<int>(std::ceil(settings.iterations * longer * longer));
}

}  // namespace wholehand::bullet
