#pragma once

#include "loop/model/hand_model.hpp"

namespace wholehand::test {

/// A hand of two links: one slides along x, the other turns about z at 0.1 m.
inline HandModel crankHand() {
  HandModel hand;
  hand.name = "crank";
  hand.joint_count = hand.axis_count = 2;
  hand.joint_names = hand.axis_names = {"x", "turn"};
  HandLink carriage;
  carriage.name = "x";
  carriage.type = JointType::kPrismatic;
  carriage.joint = 0;
  HandLink arm;
  arm.name = "turn";
  arm.parent = 0;
  arm.type = JointType::kRevolute;
  arm.axis = Eigen::Vector3d::UnitZ();
  arm.parent_to_link.translation_m = {0.0, 0.1, 0.0};
  arm.joint = 1;
  hand.links = {carriage, arm};
  hand.theta0 = JointPosition(2);
  hand.synergy = JointAxisMatrix::Identity(2, 2);
  return hand;
}

}  // namespace wholehand::test
