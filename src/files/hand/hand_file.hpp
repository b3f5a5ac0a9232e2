#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Coupling of one joint to one coordinate: θ_joint += ratio * q_coordinate.
struct SynergyTerm {
  std::string joint;
  std::string coordinate;  ///< a device axis name, e.g. "finger_flexion"
  double ratio = 0.0;
};

/// A joint of the hand file.
struct JointRange {
  std::string joint;
  double lower_rad = 0.0, upper_rad = 0.0;
  double rest_rad = 0.0;    ///< position at which a joint without a driving axis is locked
  double offset_rad = 0.0;  ///< its element of θ₀ when it is driven: its position at device zero
};

/// A pair of capsules whose contact is simulated.
struct SelfContactEntry {
  std::string capsule, other;
  int line = 0;  ///< line of the file; 0: unknown
};

/// A hand file: anthropometry and synergy, independent of a device.
struct HandFile {
  std::string path;
  std::string mirrored_path;  ///< path of the file that it mirrors; empty: it states its own sizes
  std::string name;
  Side side = Side::kRight;
  double length_m = 0.188;   ///< wrist crease to middle fingertip
  double breadth_m = 0.085;  ///< across the knuckles
  double mass_kg = 0.25;     ///< mass of the whole avatar; all links are scaled by the same factor
  std::vector<JointRange> joints;
  std::vector<SynergyTerm> synergy;
  std::vector<std::pair<std::string, double>> reference;  ///< coordinate -> position, q_ref
  std::vector<SelfContactEntry> self_contacts;
};

/// Reads and checks a hand file; `mirror_of` makes it the mirror image of another one. Reports
/// every fault of the file at once.
[[nodiscard]] Expected<HandFile> loadHandFile(const std::string& path);

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
