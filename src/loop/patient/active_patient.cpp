#include "loop/patient/active_patient.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace wholehand {

double impedanceEffort(const PatientAxis& person, double q, double qd, double q_intended,
                       double qd_intended) noexcept {
  return person.stiffness * (q_intended - q) + person.damping * (qd_intended - qd);
}

Pull pullOf(const PatientAxis& person, double q, double qd, double q_intended,
            double qd_intended) noexcept {
  const double effort = impedanceEffort(person, q, qd, q_intended, qd_intended);
  if (!(std::abs(effort) > person.strength)) return {q_intended, qd_intended};
  const double most = std::copysign(person.strength, effort);
  if (person.stiffness > 0.0) return {q + most / person.stiffness, qd};
  return {q, qd + most / person.damping};
}

double linkedEffort(const PatientLinks& links, int axis, const AxisPosition& e,
                    const AxisVelocity& ed) noexcept {
  if (links.stiffness.size() == 0) return 0.0;
  double effort = 0.0;
  for (int k = 0; k < e.size(); ++k) {
    effort += links.stiffness(axis, k) * e[k] + links.damping(axis, k) * ed[k];
  }
  return effort;
}

AxisEffort patientEffort(const PatientConfig& patient, const AxisPosition& q,
                         const AxisVelocity& qd, const AxisPosition& q_intended,
                         const AxisVelocity& qd_intended) noexcept {
  AxisEffort effort(q.size());
  AxisPosition e(q.size());
  AxisVelocity ed(q.size());
  for (int i = 0; i < q.size(); ++i) {
    effort[i] = impedanceEffort(patient.axes[i], q[i], qd[i], q_intended[i], qd_intended[i]);
    e[i] = q_intended[i] - q[i];
    ed[i] = qd_intended[i] - qd[i];
  }
  if (patient.links.stiffness.size() == 0) return effort;
  for (int i = 0; i < q.size(); ++i) effort[i] += linkedEffort(patient.links, i, e, ed);
  return effort;
}

namespace {

constexpr double kDrawBackShare = 0.2;  // speed of drawing back, as a fraction of the slam's speed
// Drawing back stops this near the end, as a fraction of the range.
constexpr double kNearEnd = 0.05;
constexpr double kReachedShare = 0.998;  // fraction of the slam's speed that counts as reached
// Longest times of drawing back and of pushing.
constexpr double kDrawBackFor_s = 1.5, kPushFor_s = 1.0;

// The effort that brings the axis to a speed within one period if everything else stays the same.
double towardsSpeed(const SlamState& state, const SlamPlan& plan, double speed, double qd,
                    double period_s) noexcept {
  const double accelerated = (qd - state.qd) / period_s;
  const double wanted = (speed - qd) / period_s;
  return std::clamp(state.effort + plan.mass * (wanted - accelerated), -plan.effort, plan.effort);
}

bool drawnBack(const SlamState& state, const SlamPlan& plan, double q) noexcept {
  const double start = plan.sign > 0.0 ? plan.lower : plan.upper;
  return std::abs(q - start) <= kNearEnd * (plan.upper - plan.lower) ||
         state.since_s >= kDrawBackFor_s;
}

constexpr double kStillShare = 0.01;  // share of the device's speed limit that counts as rest

}  // namespace

double tremorEffort(double amplitude, double frequency_hz, double phase_rad,
                    double time_s) noexcept {
  return amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s + phase_rad);
}

double openedTooFast(const StretchReflex& reflex, double qd_delayed) noexcept {
  return std::max(-qd_delayed - reflex.from_speed_rad_s, 0.0);
}

double reflexDriveFrom(const StretchReflex& reflex, double q, double too_fast) noexcept {
  return reflex.gain_nm_s_rad2 * too_fast * std::max(reflex.below_rad - q, 0.0);
}

double reflexDrive(const StretchReflex& reflex, double q, double qd_delayed) noexcept {
  return reflexDriveFrom(reflex, q, openedTooFast(reflex, qd_delayed));
}

double muscleEffort(double effort, double drive, double lag_s, double period_s) noexcept {
  return drive + (effort - drive) * std::exp(-period_s / lag_s);
}

double fightEffort(double most, double rendered, double qd, double still) noexcept {
  if (std::abs(qd) > still) return std::copysign(most, qd);
  return rendered > 0.0 ? -most : most;
}

SlamPlan planSlam(const Slam& slam, const DeviceAxis& axis) noexcept {
  SlamPlan plan;
  plan.sign = slam.towards_upper ? 1.0 : -1.0;
  plan.after_s = slam.after_s;
  plan.speed = slam.speed_share * axis.speed_limit;
  plan.effort = slam.effort_share * axis.effort_limit;
  plan.lower = axis.lower;
  plan.upper = axis.upper;
  plan.mass = axis.mass;
  return plan;
}

SlamState advanceSlam(SlamState state, const SlamPlan& plan, double q, double qd,
                      double period_s) noexcept {
  const auto enter = [&state](SlamPhase phase) {
    state.phase = phase;
    state.since_s = 0.0;
  };
  // Half a period of slack: sums of periods are not exact.
  if (state.phase == SlamPhase::kWaits && state.since_s >= plan.after_s - 0.5 * period_s) {
    enter(SlamPhase::kDrawsBack);
    state.qd = qd;
  }
  if (state.phase == SlamPhase::kDrawsBack && drawnBack(state, plan, q)) enter(SlamPhase::kPushes);
  if (state.phase == SlamPhase::kPushes &&
      (plan.sign * qd >= kReachedShare * plan.speed || state.since_s >= kPushFor_s)) {
    enter(SlamPhase::kLetGo);
  }
  const bool acts = state.phase == SlamPhase::kDrawsBack || state.phase == SlamPhase::kPushes;
  const double speed =
      plan.sign * plan.speed * (state.phase == SlamPhase::kPushes ? 1.0 : -kDrawBackShare);
  state.effort = acts ? towardsSpeed(state, plan, speed, qd, period_s) : 0.0;
  state.qd = qd;
  state.since_s += period_s;
  return state;
}

ActivePatient::ActivePatient(const PatientConfig& patient, const DeviceModel& device,
                             double period_s)
    : patient_(patient),
      period_s_(period_s),
      limit_(device.axisCount()),
      still_(device.axisCount()),
      phase_rad_(device.axisCount()),
      slam_axis_(device.axisIndex(patient.slam.axis)),
      nerve_(patient.reflex.delay_s, period_s),
      reaction_(patient.fight_reaction_s, period_s) {
  std::mt19937_64 random(patient.tremor.phase_seed);
  for (int i = 0; i < limit_.size(); ++i) {
    limit_[i] = device.axes[i].effort_limit;
    still_[i] = kStillShare * device.axes[i].speed_limit;
    phase_rad_[i] = 2.0 * std::numbers::pi * static_cast<double>(random() >> 11U) *
                    0x1.0p-53;  // same bits on every platform
  }
  along_phase_rad_ = 2.0 * std::numbers::pi * static_cast<double>(random() >> 11U) * 0x1.0p-53;
  if (slam_axis_ >= 0) {
    plan_ = planSlam(patient.slam, device.axes[slam_axis_]);
  }
  reset();
}

bool ActivePatient::mayLetGo() const noexcept {
  return slam_axis_ >= 0 || std::isfinite(patient_.letting_go.after_s) ||
         std::isfinite(patient_.letting_go.effort_share);
}

double ActivePatient::atTime(int axis, double time_s) const noexcept {
  const double amplitude = patient_.axes[axis].tremor;
  const TremorRhythm& tremor = patient_.tremor;
  double effort = 0.0;
  if (amplitude != 0.0) {
    effort = tremorEffort(amplitude, tremor.frequency_hz, phase_rad_[axis], time_s);
  }
  if (axis < tremor.along.size() && tremor.along[axis] != 0.0) {
    effort += tremorEffort(tremor.along[axis], tremor.frequency_hz, along_phase_rad_, time_s);
  }
  return effort;
}

/// Excess speed of the fastest axis over its threshold, when one axis triggers all reflexes
/// [rad/s].
double ActivePatient::fastestOpening(const AxisVelocity& qd_delayed) const noexcept {
  double most = 0.0;
  for (int i = 0; i < limit_.size(); ++i) {
    const StretchReflex& reflex = patient_.axes[i].reflex;
    if (reflex.gain_nm_s_rad2 > 0.0) {
      most = std::max(most, openedTooFast(reflex, qd_delayed[i]));
    }
  }
  return most;
}

void ActivePatient::reset() noexcept {
  const int axes = limit_.size();
  periods_ = 0;
  let_go_ = false;
  slam_ = SlamState{};
  muscle_ = AxisEffort(axes);
  nerve_.fill(AxisVelocity(axes));
  reaction_.fill({AxisEffort(axes), AxisVelocity(axes)});
  begin_ = end_ = AxisEffort(axes);
  for (int i = 0; i < axes; ++i)
    begin_[i] = end_[i] = std::clamp(atTime(i, 0.0), -limit_[i], limit_[i]);
}

bool ActivePatient::letsGo(const PatientInput& felt) const noexcept {
  const LettingGo& go = patient_.letting_go;
  const double time_s = static_cast<double>(periods_) * period_s_;
  if (slam_.phase == SlamPhase::kLetGo || time_s >= go.after_s - 0.5 * period_s_) return true;
  for (int i = 0; i < limit_.size(); ++i) {
    if (std::abs(felt.impedance[i] + end_[i]) >= go.effort_share * limit_[i]) return true;
  }
  return false;
}

void ActivePatient::advance(const PatientInput& felt) noexcept {
  if (slam_axis_ >= 0) {
    slam_ = advanceSlam(slam_, plan_, felt.q[slam_axis_], felt.qd[slam_axis_], period_s_);
  }
  const AxisVelocity& qd_delayed = nerve_.shift(felt.qd);
  const SensedState& sensed = reaction_.shift({felt.rendered, felt.qd});
  let_go_ = let_go_ || letsGo(felt);
  const double begin_s = static_cast<double>(periods_++) * period_s_;
  const double end_s = static_cast<double>(periods_) * period_s_;
  if (let_go_) {
    begin_ = end_ = AxisEffort(limit_.size());
    return;
  }
  const double fastest = patient_.reflex.largest_triggers_all ? fastestOpening(qd_delayed) : 0.0;
  for (int i = 0; i < limit_.size(); ++i) {
    const PatientAxis& axis = patient_.axes[i];
    const double pulled = muscle_[i];
    // Stretch reflex.
    if (axis.reflex.gain_nm_s_rad2 > 0.0) {
      const double too_fast = patient_.reflex.largest_triggers_all
                                  ? fastest
                                  : openedTooFast(axis.reflex, qd_delayed[i]);
      const double drive = std::min(reflexDriveFrom(axis.reflex, felt.q[i], too_fast), limit_[i]);
      muscle_[i] = muscleEffort(pulled, drive, patient_.reflex.muscle_lag_s, period_s_);
    }
    const double fight = axis.fight > 0.0
                             ? fightEffort(axis.fight, sensed.rendered[i], sensed.qd[i], still_[i])
                             : 0.0;
    // Sum of tremor, reflex, fight and slam.
    const double begin = atTime(i, begin_s) + pulled + fight;
    const double end = atTime(i, end_s) + muscle_[i] + fight;
    const double slam = i == slam_axis_ ? slam_.effort : 0.0;
    begin_[i] = std::clamp(begin, -limit_[i], limit_[i]) + slam;
    end_[i] = std::clamp(end, -limit_[i], limit_[i]) + slam;
  }
}

}  // namespace wholehand
