#pragma once

#include <string>

namespace wholehand::test {

/// Which laws of the conformance suite an engine is held to, and how near it comes to each. The
/// defaults are asked of every engine that a person may be attached to.
struct Bounds {
  bool contact_laws = true;          ///< those of pressed, grasped and sliding contacts, too
  double free_motion = 1e-9;         ///< of q̈_s = M_r⁻¹ f_s, a step [m/s or rad/s]
  double momentum_ns = 1e-12;        ///< action against reaction
  double beyond_cone = 1e-9;         ///< tangential over allowed friction force, less 1
  double sliding_share = 0.01;       ///< speed of a block that slides
  double moved_at_rest_m = 2e-4;     ///< in 1.5 s
  double turned_at_rest_rad = 5e-3;  ///< the same
  double mirror = 1e-7;              ///< left hand against right [m or rad]
  double virtual_work_n = 1e-9;      ///< of contacts against the drive, in each step
  double virtual_work_nm = 1e-9;     ///< the same, rotations
  bool armature = true;              ///< contacts bear what the drive asks of the armature, too
  double synergy_rad = 1e-9;         ///< left of θ − (θ₀ + G q_s), before correction
  double carried_share = 1e-3;       ///< force of a contact at rest against what is asked
  double surface_m = 2e-5;           ///< overlap or gap of a contact at rest
  double slammed_m = 1e-4;           ///< overlap after a slam has settled
  double slam_strides = 1.0;         ///< deepest overlap of a slam, in ways of one period
  int grasps_held = 12;              ///< of the 12 tuned ones
  double slip_m = 3.3e-5;            ///< in 10 s, of those that are held
  double grasp_residual = 0.01;      ///< contact forces against the drive, of those
  double sliding_wall_m = 3e-5;      ///< overlap with a wall that slides into the hand
  double let_go_m = 1e-4;            ///< what a hand moves when its contact is taken away
  int bodies = 1024;                 ///< of the largest scene: what a scene file may have
};

[[nodiscard]] const Bounds& boundsOf(const std::string& engine);

}  // namespace wholehand::test
