#include "device/simulated/simulated_device.hpp"

#include "patient/scripted_player.hpp"
#include "patient/virtual_patient.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {

SimulatedDevice::SimulatedDevice(const DeviceModel& device, const PatientConfig& patient,
                                 Intention intention, double period_s)
    : SimulatedDevice(device, patient, std::make_unique<ScriptedPlayer>(std::move(intention)),
                      period_s) {}

SimulatedDevice::SimulatedDevice(const DeviceModel& device, const PatientConfig& patient,
                                 std::unique_ptr<Player> player, double period_s)
    : device_(device),
      patient_(patient),
      player_(std::move(player)),
      period_s_(period_s),
      neutral_(device.axisCount()) {
  device_.output_delay_ticks = std::clamp(device_.output_delay_ticks, 0, kMostDelay);
  for (int i = 0; i < device_.axisCount(); ++i) {
    const DeviceAxis& axis = device_.axes[i];
    const PatientAxis& person = patient_.axes[i];
    neutral_[i] = axis.neutral_effort;
    axes_.emplace_back(AxisPlant{axis.mass + person.mass, axis.damping + person.damping,
                                 person.stiffness, axis.coulomb, axis.lower, axis.upper},
                       period_s_);
  }
}

Expected<Done> SimulatedDevice::open() {
  open_ = true;
  fresh_ = true;
  oldest_ = 0;
  commanded_ = acting_ = neutral_;
  delayed_.fill(neutral_);
  player_->reset();
  q_intended_ = player_->start();
  qd_intended_ = AxisVelocity(device_.axisCount());
  q_ = AxisPosition(device_.axisCount());
  qd_ = AxisVelocity(device_.axisCount());
  for (int i = 0; i < q_.size(); ++i) {
    axes_[i].place(q_intended_[i], 0.0);
    q_[i] = axes_[i].position();
  }
  return Done{};
}

void SimulatedDevice::shiftDelayLine() noexcept {
  if (device_.output_delay_ticks == 0) {
    acting_ = commanded_;
    return;
  }
  acting_ = delayed_[oldest_];
  delayed_[oldest_] = commanded_;
  oldest_ = (oldest_ + 1) % device_.output_delay_ticks;
}

void SimulatedDevice::letPeriodPass() noexcept {
  shiftDelayLine();
  AxisPosition aim;
  AxisVelocity aim_speed;
  player_->advance(period_s_, aim, aim_speed);
  for (int i = 0; i < q_.size(); ++i) {
    const PatientAxis& person = patient_.axes[i];
    // The plant holds the person's K and B towards zero; what remains is the pull of the aim.
    const double held = acting_[i] - neutral_[i];
    axes_[i].advance({held + impedanceEffort(person, 0.0, 0.0, q_intended_[i], qd_intended_[i]),
                      held + impedanceEffort(person, 0.0, 0.0, aim[i], aim_speed[i])});
    q_[i] = axes_[i].position();
    qd_[i] = axes_[i].velocity();
  }
  q_intended_ = aim;
  qd_intended_ = aim_speed;
}

Fault SimulatedDevice::read(DeviceReading& reading, int elapsed_periods) noexcept {
  if (!open_) return Fault::kDeviceRead;
  if (!std::exchange(fresh_, false)) {
    for (int i = 0; i < elapsed_periods; ++i) letPeriodPass();
  }
  reading.q_m = q_;
  for (int i = 0; i < q_.size(); ++i) {
    const double step = device_.axes[i].encoder_step;
    if (step > 0.0) reading.q_m[i] = step * std::round(q_[i] / step);
  }
  reading.intention = q_intended_;
  reading.patient_effort = patientEffort(patient_, q_, qd_, q_intended_, qd_intended_);
  return Fault::kNone;
}

Fault SimulatedDevice::write(const AxisEffort& effort) noexcept {
  if (!open_ || effort.size() != device_.axisCount() || !allFinite(effort)) {
    return Fault::kDeviceWrite;
  }
  for (int i = 0; i < effort.size(); ++i) {
    const double limit = device_.axes[i].effort_limit;
    commanded_[i] = std::clamp(effort[i], -limit, limit);
  }
  return Fault::kNone;
}

void SimulatedDevice::close() noexcept {
  open_ = false;
  commanded_ = acting_ = neutral_;
  delayed_.fill(neutral_);
}

}  // namespace wholehand
