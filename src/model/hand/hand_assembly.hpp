#pragma once

#include "model/device_model.hpp"
#include "model/hand/hand_file.hpp"
#include "model/hand/hand_model.hpp"

namespace wholehand {

/// Index of the device's hand axis of that name; -1: none.
[[nodiscard]] int handAxisIndex(const DeviceModel& device, const std::string& name);

/// The hand file's entry of a joint; null: none.
[[nodiscard]] const JointRange* findJoint(const HandFile& hand, const std::string& joint);

/// Builds the links, capsules, masses and joint names of the hand for a device: a HandModel without
/// synergy map, θ₀ and reference posture.
/// @pre hand.joints has every joint of handJointNames(); every base axis is named x .. yaw
[[nodiscard]] HandModel buildLinks(const HandFile& hand, const DeviceModel& device);

/// Builds the hand for a device: capsules and inertias from the anthropometry, base joints for the
/// device's base axes (translations x, y, z in the world, then roll, pitch, yaw about the hand's x,
/// y, z in series, roll first, through the palm frame's origin), joints without a driving axis
/// locked at rest (JointType::kFixed, the rest angle baked into parent_to_link). An axis that
/// drives nothing, or a synergy term on an unknown joint, is an error.
[[nodiscard]] Expected<HandModel> assembleHand(const HandFile& hand, const DeviceModel& device);

}  // namespace wholehand
