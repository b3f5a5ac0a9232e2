#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/patient_config.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

// Behaviour of a person on one axis. Pure laws: state in, state out. Real-time safe.
namespace wholehand {

/// Effort of the person's impedance on one axis: K (q_i - q) + B (q̇_i - q̇) [N or N·m]. The
/// person's inertia is excluded; it moves with the device. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double impedanceEffort(const PatientAxis& person, double q, double qd,
                                                  double q_intended, double qd_intended) noexcept;

/// Position and speed towards which a person of limited strength pulls: the intended ones, or
/// nearer ones at which the effort of the impedance equals the person's strength on the axis.
/// Real-time safe.
struct Pull {
  double q, qd;
};
[[nodiscard]] WHOLEHAND_RT Pull pullOf(const PatientAxis& person, double q, double qd,
                                       double q_intended, double qd_intended) noexcept;

/// Effort that the links add on one axis: K e + B ė of the other axes, where e and ė are the lead
/// of the intention over the device [N or N·m]. 0 without links. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double linkedEffort(const PatientLinks& links, int axis,
                                               const AxisPosition& e,
                                               const AxisVelocity& ed) noexcept;

/// Impedance of every axis including links: f = K (q_i - q) + B (q̇_i - q̇), K and B symmetric.
/// @pre all arrays have the patient's number of axes. Real-time safe.
[[nodiscard]] WHOLEHAND_RT AxisEffort patientEffort(const PatientConfig& patient,
                                                    const AxisPosition& q, const AxisVelocity& qd,
                                                    const AxisPosition& q_intended,
                                                    const AxisVelocity& qd_intended) noexcept;

/// Delay line of fixed length. Its memory is allocated in the constructor.
template <class Value>
class DelayLine {
 public:
  /// Rounds the delay to whole periods. Not real-time safe.
  DelayLine(double delay_s, double period_s)
      : values_(std::max(std::lround(delay_s / period_s), 0L) + 1) {}

  /// Fills the history with a value. Real-time safe.
  WHOLEHAND_RT void fill(const Value& value) noexcept {
    std::fill(values_.begin(), values_.end(), value);
    newest_ = 0;
  }

  /// Stores the present value and returns the delayed one. Call once a period. Real-time safe.
  WHOLEHAND_RT const Value& shift(const Value& value) noexcept {
    newest_ = (newest_ + 1) % values_.size();
    values_[newest_] = value;
    return values_[(newest_ + 1) % values_.size()];
  }

 private:
  std::vector<Value> values_;
  std::size_t newest_ = 0;
};

/// Effort of a tremor: A sin(2π f t + phase) [N or N·m].
[[nodiscard]] WHOLEHAND_RT double tremorEffort(double amplitude, double frequency_hz,
                                               double phase_rad, double time_s) noexcept;

/// Speed by which opening exceeds the reflex's threshold: (v - v_th)₊ with v = -q̇ delayed [rad/s].
[[nodiscard]] WHOLEHAND_RT double openedTooFast(const StretchReflex& reflex,
                                                double qd_delayed) noexcept;

/// Reflex drive g (v - v_th)₊ (s - s_th)₊ for a given excess speed v - v_th, which may be that of
/// another axis. [N·m]
[[nodiscard]] WHOLEHAND_RT double reflexDriveFrom(const StretchReflex& reflex, double q,
                                                  double too_fast) noexcept;

/// Drive of the reflex to the muscle: g (v - v_th)₊ (s - s_th)₊ >= 0, in the direction of flexion.
/// Stretch is opening: v = -q̇ delayed and s - s_th = below - q. [N·m]
[[nodiscard]] WHOLEHAND_RT double reflexDrive(const StretchReflex& reflex, double q,
                                              double qd_delayed) noexcept;

/// First-order response to the drive, exact for a drive constant over the period. @pre lag_s > 0
[[nodiscard]] WHOLEHAND_RT double muscleEffort(double effort, double drive, double lag_s,
                                               double period_s) noexcept;

/// Effort of a person who fights the device: the full effort `most` along the motion, so that it
/// always injects energy. At speeds below `still` it acts against the rendered effort, or upwards
/// when there is none. [N or N·m]
[[nodiscard]] WHOLEHAND_RT double fightEffort(double most, double rendered, double qd,
                                              double still) noexcept;

/// A slam within the limits of this device.
struct SlamPlan {
  double sign = 1.0;                ///< sign of the direction
  double after_s = 0.0;             ///< start time of drawing back
  double speed = 1.0;               ///< target speed [m/s or rad/s], > 0
  double effort = 1.0;              ///< largest effort [N or N·m], > 0
  double lower = 0.0, upper = 0.0;  ///< range [m or rad]
  double mass = 1.0;                ///< mass of the bare axis [kg or kg·m²], > 0
};
[[nodiscard]] SlamPlan planSlam(const Slam& slam, const DeviceAxis& axis) noexcept;

enum class SlamPhase { kWaits, kDrawsBack, kPushes, kLetGo };
struct SlamState {
  SlamPhase phase = SlamPhase::kWaits;
  double since_s = 0.0;  ///< time in this phase
  double effort = 0.0;   ///< effort over the next period [N or N·m]
  double qd = 0.0;       ///< velocity one period ago [m/s or rad/s]
};
/// Advances a slam by one period. The effort is chosen to reach the wanted speed one period later,
/// assuming that the resistance of the last period stays. The person first draws back at a fifth of
/// the speed, to the other end of the range or for 1.5 s; then pushes until the speed is reached,
/// at most for 1 s; then lets go.
[[nodiscard]] WHOLEHAND_RT SlamState advanceSlam(SlamState state, const SlamPlan& plan, double q,
                                                 double qd, double period_s) noexcept;

/// State that the person perceives at the beginning of a period.
struct PatientInput {
  AxisPosition q;        ///< true position of the device [m or rad]
  AxisVelocity qd;       ///< true velocity [m/s or rad/s]
  AxisEffort rendered;   ///< effort of the device over the last period, without its weight
  AxisEffort impedance;  ///< present effort of the person's impedance
};

/// Active behaviour of a person, period by period: tremor, spastic catch, fight, slam and letting
/// go. The sum is limited to the device's effort limit on each axis, except during a slam, because
/// an arm is stronger than a device. The device adds the person's impedance on the axes that
/// holds() names. Deterministic for a given seed.
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

  /// True while the person's impedance acts on that axis: neither after letting go nor, on the
  /// slammed axis, during a slam.
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
  struct SensedState {
    AxisEffort rendered;
    AxisVelocity qd;
  };
  DelayLine<SensedState> reaction_;

  std::int64_t periods_ = 0;
  bool let_go_ = false;
  SlamState slam_;
  AxisEffort muscle_;
  AxisEffort begin_, end_;
};

}  // namespace wholehand
