#pragma once

#include "model/device_model.hpp"
#include "model/hand_file.hpp"
#include "model/hand_model.hpp"

namespace wholehand {

/// Index of the device's axis of that name that moves joints of the hand; -1 when there is none.
[[nodiscard]] int handAxisIndex(const DeviceModel& device, const std::string& name);

/// The hand file's entry for a joint; null when there is none.
[[nodiscard]] const JointRange* findJoint(const HandFile& hand, const std::string& joint);

/// Links, capsules, masses and joint names of the hand on that device: everything of a HandModel
/// but the synergy map, θ₀ and the reference posture.
/// @pre hand.joints has every joint of handJointNames(); every base axis is named x .. yaw
[[nodiscard]] HandModel buildLinks(const HandFile& hand, const DeviceModel& device);

}  // namespace wholehand
