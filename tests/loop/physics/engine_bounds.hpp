#pragma once

#include <string>

namespace wholehand::test {

/// The laws of the conformance suite that an engine must satisfy, and its tolerance for each. The
/// defaults apply to every engine that is allowed for devices that hold a person.
struct Bounds {
  bool contact_laws = true;          ///< also the laws of pressed, grasped and sliding contacts
  double free_motion = 1e-9;         ///< error of q̈_s = M_r⁻¹ f_s in a step [m/s or rad/s]
  double momentum_ns = 1e-12;        ///< action against reaction [N·s]
  double beyond_cone = 1e-9;         ///< tangential force over allowed friction force, less 1
  double sliding_share = 0.01;       ///< relative error of the speed of a sliding block
  double moved_at_rest_m = 2e-4;     ///< motion in 1.5 s
  double turned_at_rest_rad = 5e-3;  ///< rotation in 1.5 s
  double mirror = 1e-7;              ///< left hand against right hand [m or rad]
  double virtual_work_n = 1e-9;   ///< virtual work of contacts against the drive, in each step [N]
  double virtual_work_nm = 1e-9;  ///< the same for rotations [N·m]
  bool armature = true;           ///< contacts also carry the drive's share for the armature
  double synergy_rad = 1e-9;      ///< remainder of θ − (θ₀ + G q_s) before correction
  double carried_share =
      1e-3;                   ///< force of a resting contact against the requested force, relative
  double surface_m = 2e-5;    ///< overlap or gap of a resting contact
  double slammed_m = 1e-4;    ///< overlap after a slam has settled
  double slam_strides = 1.0;  ///< deepest overlap of a slam, in distances travelled per period
  int grasps_held = 12;       ///< out of the 12 tuned grasps
  double slip_m = 3.3e-5;     ///< slip in 10 s of the held grasps
  double grasp_residual = 0.01;  ///< contact forces against the drive, relative, of the held grasps
  double sliding_wall_m = 3e-5;  ///< overlap with a wall that slides into the hand
  double let_go_m = 1e-4;        ///< motion of a hand when its contact is removed
  int bodies = 1024;             ///< in the largest scene; the default is a scene file's limit
};

[[nodiscard]] const Bounds& boundsOf(const std::string& engine);

}  // namespace wholehand::test
