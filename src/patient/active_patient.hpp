#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/device_model.hpp"
#include "model/patient/patient_config.hpp"
#include "patient/delay_line.hpp"
#include "patient/habits.hpp"

#include <array>
#include <cstdint>

namespace wholehand {

/// State that the person perceives at the beginning of a period.
struct PatientInput {
  AxisPosition q;        ///< true position of the device [m or rad]
  AxisVelocity qd;       ///< true velocity [m/s or rad/s]
  AxisEffort rendered;   ///< effort of the device over the last period, without its weight
  AxisEffort impedance;  ///< effort of the person's impedance, now
};

/// Active behaviour of a person, period by period: tremor, spastic catch, fight, slam and letting
/// go. The sum is limited to the device's effort limit on each axis, except for a slam, because an
/// arm is stronger than a device. The device adds the person's impedance as far as holds() says.
/// Deterministic by the seed.
class ActivePatient {
 public:
  /// @pre the patient has the device's axes. Not real-time safe.
  ActivePatient(const PatientConfig& patient, const DeviceModel& device, double period_s);

  /// Resets to the start: holds the device, nothing perceived yet. Real-time safe.
  WHOLEHAND_RT void reset() noexcept;

  /// Advances one period. Real-time safe.
  WHOLEHAND_RT void advance(const PatientInput& felt) noexcept;

  /// Efforts at the beginning and end of the period, linear between.
  [[nodiscard]] const AxisEffort& begin() const noexcept { return begin_; }
  [[nodiscard]] const AxisEffort& end() const noexcept { return end_; }

  /// Whether the person's impedance acts on that axis: not after letting go, nor on an axis during
  /// a slam.
  [[nodiscard]] bool holds(int axis) const noexcept {
    return !let_go_ && (axis != slam_axis_ || slam_.phase == SlamPhase::kWaits);
  }
  [[nodiscard]] bool hasLetGo() const noexcept { return let_go_; }
  /// The slammed axis; -1: none.
  [[nodiscard]] int slamAxis() const noexcept { return slam_axis_; }
  /// False if holds() is always true.
  [[nodiscard]] bool mayLetGo() const noexcept;

 private:
  [[nodiscard]] bool letsGo(const PatientInput& felt) const noexcept;
  [[nodiscard]] double atTime(int axis, double time_s) const noexcept;
  [[nodiscard]] double fastestOpening(const AxisVelocity& qd_delayed) const noexcept;

  PatientConfig patient_;
  double period_s_;
  AxisEffort limit_;
  AxisVelocity still_;  ///< speeds below this count as rest
  AxisPosition phase_rad_;
  double along_phase_rad_ = 0.0;  ///< phase of the tremor along a direction
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
