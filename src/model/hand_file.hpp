#pragma once

#include "core/expected.hpp"
#include "model/device_model.hpp"
#include "model/hand_model.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// How one joint follows one coordinate: θ_joint += ratio * q_coordinate.
struct SynergyTerm {
  std::string joint;
  std::string coordinate;  ///< a device axis name, e.g. "finger_flexion"
  double ratio = 0.0;
};

/// A joint of the hand file.
struct JointRange {
  std::string joint;
  double lower_rad = 0.0, upper_rad = 0.0;
  double rest_rad = 0.0;    ///< where the joint is locked when no axis of the device drives it
  double offset_rad = 0.0;  ///< its share of θ₀ when one does: where it is at zero of the device
};

/// A pair of capsules that stop each other.
struct SelfContactEntry {
  std::string capsule, other;
  int line = 0;  ///< of the file; 0 when unknown
};

/// A hand file: anthropometry and synergy, before it meets a device.
struct HandFile {
  std::string path;
  std::string mirrored_path;  ///< of the file that this one mirrors; empty: it has its own sizes
  std::string name;
  Side side = Side::kRight;
  double length_m = 0.188;   ///< wrist crease to middle fingertip
  double breadth_m = 0.085;  ///< across the knuckles
  double mass_kg = 0.25;     ///< of the whole avatar; every link is scaled alike
  std::vector<JointRange> joints;
  std::vector<SynergyTerm> synergy;
  std::vector<std::pair<std::string, double>> reference;  ///< coordinate -> position, q_ref
  std::vector<SelfContactEntry> self_contacts;
};

/// Reads and checks a hand file; a file with `mirror_of` is another one's mirror image. Every fault
/// of the file is reported at once.
[[nodiscard]] Expected<HandFile> loadHandFile(const std::string& path);

/// Builds the hand that a device drives: capsules and inertias from the anthropometry, base joints
/// for the device's base axes (translations x, y, z in the world, then roll, pitch, yaw about the
/// hand's x, y, z in series, roll first, through the palm frame's origin), joints that no axis
/// drives locked at rest (JointType::kFixed, the rest angle baked into parent_to_link). An axis
/// that drives nothing, or a synergy term on an unknown joint, is an error.
[[nodiscard]] Expected<HandModel> assembleHand(const HandFile& hand, const DeviceModel& device);

}  // namespace wholehand
