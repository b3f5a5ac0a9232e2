#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/geometry.hpp"
#include "schema_enums.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace wholehand {

enum class Side { kRight, kLeft };

/// A collider: a segment with a radius, in its link's frame.
struct Capsule {
  std::string name;  ///< "index_proximal", "palm_metacarpal_2", ...
  HandPart part = HandPart::kPalm;
  int link = 0;  ///< index into HandModel::links
  Eigen::Vector3d a_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d b_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
};

/// Two capsules of a hand whose contact is simulated.
struct SelfPair {
  int capsule_a = -1;  ///< index into HandModel::capsules
  int capsule_b = -1;
};

/// A rigid link and its joint. The link frame coincides with the joint frame at joint position
/// zero. A revolute joint rotates the link about `axis` through the frame's origin; a prismatic
/// joint moves it along `axis`.
struct HandLink {
  std::string name;  ///< name of the joint: "x", "index_mcp_flexion", ...
  int parent = -1;   ///< index of the parent link, -1 for the world; always < own index
  JointType type = JointType::kFixed;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< unit, in the link frame
  Pose parent_to_link;  ///< link frame in the parent's frame at joint position zero
  int joint = -1;       ///< index into the joint arrays; -1 for a fixed (locked) joint
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();          ///< link frame
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about the com, link axes
  double lower = 0.0, upper = 0.0;  ///< joint range from the file [m or rad]
};

/// The simulated hand for the tick: a tree of links, its capsules, and the synergy map from the
/// device's axes to the driven joints. Immutable.
///
/// World frame: right-handed, z up, x away from the person, y left. Palm frame of the file: x
/// distal, y radial, z dorsal for a right hand; a left hand is its mirror image in y. Flexion is
/// positive. Joint positions θ = θ₀ + G q_s.
struct HandModel {
  std::string name;
  Side side = Side::kRight;
  std::vector<HandLink> links;  ///< parents first
  std::vector<Capsule> capsules;
  std::vector<SelfPair> self_contacts;   ///< pairs with relative motion, in file order
  int palm_link = 0;                     ///< the link that carries the palm
  int joint_count = 0;                   ///< driven joints, N_j
  int axis_count = 0;                    ///< device axes, N
  std::vector<std::string> joint_names;  ///< size joint_count
  std::vector<std::string> axis_names;   ///< size axis_count, the device's order
  JointPosition theta0;                  ///< θ₀
  JointAxisMatrix synergy;               ///< G, joint_count x axis_count
  AxisPosition reference;                ///< q_ref: posture in which gains are chosen
  AxisPosition axis_lower, axis_upper;   ///< ranges of the device's axes
  double total_mass_kg = 0.0;
};

}  // namespace wholehand
