#pragma once

#include "device/simulated/linked_dynamics.hpp"
#include "model/device_model.hpp"
#include "model/patient/patient_config.hpp"

#include <array>
#include <vector>

namespace wholehand {

/// The axes of a device that its person links. They move together while held. After a slam of one
/// axis the others stay linked; after letting go, none is.
class LinkedPerson {
 public:
  /// axis that may be released before the others; -1: none
  LinkedPerson(const DeviceModel& device, const PatientConfig& patient, double period_s,
               int slam_axis);

  /// Whether the axis now moves linked to others. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT bool moves(int axis) const noexcept { return moved_[axis]; }

  /// Sets the state with all axes held. Real-time safe.
  WHOLEHAND_RT void place(const AxisPosition& q, const AxisVelocity& qd) noexcept;

  /// Updates which axes the person holds, and their state. Real-time safe.
  WHOLEHAND_RT void hold(const std::array<bool, kMaxAxes>& held, const AxisPosition& q,
                         const AxisVelocity& qd) noexcept;

  /// Advances the linked axes by one period under their efforts. Real-time safe.
  WHOLEHAND_RT void advance(const AxisEffort& begin, const AxisEffort& end, AxisPosition& q,
                            AxisVelocity& qd) noexcept;

 private:
  struct Group {
    std::vector<int> axes;
    LinkedDynamics dynamics;
  };
  void enter(int group, const AxisPosition& q, const AxisVelocity& qd) noexcept;

  std::vector<Group> groups_;  ///< all linked axes; all but the slammed one
  int now_ = -1;               ///< current group; -1: no axis is linked
  std::array<bool, kMaxAxes> moved_{};
};

}  // namespace wholehand
