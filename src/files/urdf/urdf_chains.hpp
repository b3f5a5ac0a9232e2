#pragma once

#include "loop/model/scene_model.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A movable joint of a URDF and what it has to do with others.
struct LinkedJoint {
  std::string name;
  bool movable = true;  ///< false: a fixed joint, which another one may name
  int carrier = -1;     ///< joint whose link carries this one; -1: none, the root stands
  bool mimics = false;  ///< has a <mimic>
  std::string leader;   ///< name of the joint that it follows
  double ratio = 1.0;   ///< its position is ratio · leader + offset
  double offset = 0.0;  ///< [rad; m]
  SceneJoint* joint = nullptr;
  int follows = -1;  ///< set by linkJoints(): the joint that leads, which follows none; -1: itself
};

/// A fault or a notice of one of the joints.
struct JointRemark {
  int joint = 0;
  bool of_mimic = false;  ///< it concerns the <mimic>
  std::string value, problem, remedy;
};
struct JointRemarks {
  std::vector<JointRemark> faults, notices;
};

/// Largest number of coordinates that may move each other.
inline constexpr int kMostCoordinates = 3;

/// Finds the joint that each <mimic> leads back to, with the whole ratio and offset; narrows the
/// range of a leading joint to where its followers can go; refuses joints that follow nothing that
/// moves, or each other, and more than kMostCoordinates joints that move each other.
[[nodiscard]] JointRemarks linkJoints(std::vector<LinkedJoint>& joints);

}  // namespace wholehand
