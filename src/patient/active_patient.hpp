#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/device_model.hpp"
#include "model/patient_config.hpp"
#include "patient/delay_line.hpp"
#include "patient/habits.hpp"

#include <array>
#include <cstdint>

namespace wholehand {

/// What the person knows when a period begins.
struct FeltByPatient {
  AxisPosition q;        ///< true position of the device [m or rad]
  AxisVelocity qd;       ///< true velocity [m/s or rad/s]
  AxisEffort rendered;   ///< what the device did over the last period, its weight not counted
  AxisEffort impedance;  ///< of the person, now
};

/// What a person does of their own accord, period by period: tremor, spastic catch, fight, slam,
/// and letting go. All of it together is held to the device's effort limit on each axis, but for a
/// slam: an arm is stronger than a device. The impedance is the device's business, and no more
/// where holds() says so. Deterministic by the seed.
class ActivePatient {
 public:
  /// @pre the patient has the device's axes. Not real-time safe.
  ActivePatient(const PatientConfig& patient, const DeviceModel& device, double period_s);

  /// Back to the beginning: holds the device, nothing felt yet. Real-time safe.
  WHOLEHAND_RT void reset() noexcept;

  /// One period. Real-time safe.
  WHOLEHAND_RT void advance(const FeltByPatient& felt) noexcept;

  /// The efforts at the beginning and end of the period, linear between them.
  [[nodiscard]] const AxisEffort& begin() const noexcept { return begin_; }
  [[nodiscard]] const AxisEffort& end() const noexcept { return end_; }

  /// Whether the person's impedance is on that axis: not after letting go, nor where they push.
  [[nodiscard]] bool holds(int axis) const noexcept {
    return !let_go_ && (axis != slam_axis_ || slam_.phase == SlamPhase::kWaits);
  }
  [[nodiscard]] bool hasLetGo() const noexcept { return let_go_; }
  /// The axis that is slammed; -1: none.
  [[nodiscard]] int slamAxis() const noexcept { return slam_axis_; }
  /// False where holds() is true whatever happens.
  [[nodiscard]] bool mayLetGo() const noexcept;

 private:
  [[nodiscard]] bool letsGo(const FeltByPatient& felt) const noexcept;
  [[nodiscard]] double atTime(int axis, double time_s) const noexcept;
  [[nodiscard]] double fastestOpening(const AxisVelocity& qd_delayed) const noexcept;

  PatientConfig patient_;
  double period_s_;
  AxisEffort limit_;
  AxisVelocity still_;  ///< slower feels like rest
  AxisPosition phase_rad_;
  double along_phase_rad_ = 0.0;  ///< of the tremor along a direction
  int slam_axis_ = -1;
  SlamPlan plan_;
  DelayLine<AxisVelocity> nerve_;
  struct Sensed {
    AxisEffort rendered;
    AxisVelocity qd;
  };
  DelayLine<Sensed> reaction_;

  std::int64_t periods_ = 0;
  bool let_go_ = false;
  SlamState slam_;
  AxisEffort muscle_;
  AxisEffort begin_, end_;
};

}  // namespace wholehand
