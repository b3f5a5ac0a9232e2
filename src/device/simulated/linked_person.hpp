#pragma once

#include "device/simulated/linked_dynamics.hpp"
#include "model/device_model.hpp"
#include "model/patient_config.hpp"

#include <array>
#include <vector>

namespace wholehand {

/// The axes of a device that its person links, moving together for as long as they are held. An
/// axis that is slammed leaves the others linked; once let go, none is.
class LinkedPerson {
 public:
  /// @param slam_axis may be let go before the others; -1: none  Not real-time safe.
  LinkedPerson(const DeviceModel& device, const PatientConfig& patient, double period_s,
               int slam_axis);

  /// Whether the axis moves with others here, now. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT bool moves(int axis) const noexcept {
    return moved_[static_cast<std::size_t>(axis)];
  }

  /// All axes held, put somewhere. Real-time safe.
  WHOLEHAND_RT void place(const AxisPosition& q, const AxisVelocity& qd) noexcept;

  /// Which axes the person holds now, and where they are. Real-time safe.
  WHOLEHAND_RT void hold(const std::array<bool, kMaxAxes>& held, const AxisPosition& q,
                         const AxisVelocity& qd) noexcept;

  /// One period: efforts of the axes that move here, and where that leaves them. Real-time safe.
  WHOLEHAND_RT void advance(const AxisEffort& begin, const AxisEffort& end, AxisPosition& q,
                            AxisVelocity& qd) noexcept;

 private:
  struct Group {
    std::vector<int> axes;
    LinkedDynamics dynamics;
  };
  void enter(int group, const AxisPosition& q, const AxisVelocity& qd) noexcept;

  std::vector<Group> groups_;  ///< all linked axes; the same without the one that is slammed
  int now_ = -1;               ///< of the groups; -1: no axis moves here
  std::array<bool, kMaxAxes> moved_{};
};

}  // namespace wholehand
