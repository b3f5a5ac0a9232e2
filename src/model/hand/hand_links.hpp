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

}  // namespace wholehand
