#include "loop/device/simulated/simulated_device.hpp"

#include "loop/patient/active_patient.hpp"
#include "loop/patient/motion.hpp"

#include <algorithm>
#include <utility>

namespace wholehand {

namespace {

// A longer gap ends rendering anyway; the device stands still for the rest of it.
constexpr double kLongestGap_s = 1.0;

}  // namespace

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
      person_(patient, device, period_s),
      neutral_(device.axisCount()),
      linked_(device, patient, period_s, person_.slamAxis()) {
  device_.output_delay_ticks = std::clamp(device_.output_delay_ticks, 0, kMostDelay);
  for (int i = 0; i < device_.axisCount(); ++i) {
    const DeviceAxis& axis = device_.axes[i];
    const PatientAxis& person = patient_.axes[i];
    neutral_[i] = axis.neutral_effort;
    axes_.emplace_back(AxisPlant{axis.mass + person.mass, axis.damping + person.damping,
                                 person.stiffness, axis.coulomb, axis.lower, axis.upper},
                       period_s_);
    if (!person_.mayLetGo()) continue;
    bare_.emplace_back(
        AxisPlant{axis.mass, axis.damping, 0.0, axis.coulomb, axis.lower, axis.upper}, period_s_);
  }
}

Expected<Done> SimulatedDevice::open() {
  open_ = true;
  fresh_ = true;
  oldest_ = 0;
  commanded_ = acting_ = neutral_;
  delayed_.fill(neutral_);
  player_->reset();
  person_.reset();
  held_.fill(true);
  q_intended_ = q_pull_ = player_->start();
  qd_pull_ = AxisVelocity(device_.axisCount());
  q_ = AxisPosition(device_.axisCount());
  qd_ = AxisVelocity(device_.axisCount());
  for (int i = 0; i < q_.size(); ++i) {
    axes_[i].place(q_intended_[i], 0.0);
    q_[i] = axes_[i].position();
  }
  linked_.place(q_, qd_);
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

AxisEffort SimulatedDevice::impedance() const noexcept {
  // A released axis has no position error, so it does not pull the linked axes.
  AxisPosition q_meant = q_pull_;
  AxisVelocity qd_meant = qd_pull_;
  for (int i = 0; i < q_.size(); ++i) {
    if (person_.holds(i)) continue;
    q_meant[i] = q_[i];
    qd_meant[i] = qd_[i];
  }
  AxisEffort effort = patientEffort(patient_, q_, qd_, q_meant, qd_meant);
  for (int i = 0; i < q_.size(); ++i) {
    if (!person_.holds(i)) effort[i] = 0.0;
  }
  return effort;
}

void SimulatedDevice::letPersonAct() noexcept {
  AxisEffort rendered = acting_;
  for (int i = 0; i < rendered.size(); ++i) rendered[i] -= neutral_[i];
  person_.advance({q_, qd_, rendered, impedance()});
  for (int i = 0; i < q_.size(); ++i) {
    // On release the bare mechanism keeps its velocity; the person's mass takes its own momentum
    // along.
    if (std::exchange(held_[i], person_.holds(i)) && !held_[i]) bare_[i].place(q_[i], qd_[i]);
  }
  linked_.hold(held_, q_, qd_);
}

void SimulatedDevice::moveAxes(const AxisPosition& aim, const AxisVelocity& aim_speed) noexcept {
  AxisPosition from = q_pull_, to = aim;
  AxisVelocity from_speed = qd_pull_, to_speed = aim_speed;
  for (int i = 0; i < q_.size(); ++i) {
    if (!held_[i]) from[i] = to[i] = from_speed[i] = to_speed[i] = 0.0;
  }
  AxisEffort begin(q_.size()), end(q_.size());
  for (int i = 0; i < q_.size(); ++i) {
    const PatientAxis& person = patient_.axes[i];
    // The plant contains the person's K and B towards zero. The remaining part of the impedance is
    // the pull towards the target.
    EffortRamp effort;
    if (held_[i]) {
      effort.begin = impedanceEffort(person, 0.0, 0.0, from[i], from_speed[i]);
      effort.end = impedanceEffort(person, 0.0, 0.0, to[i], to_speed[i]);
    }
    effort.begin += acting_[i] - neutral_[i] + person_.begin()[i];
    effort.end += acting_[i] - neutral_[i] + person_.end()[i];
    if (linked_.moves(i)) {
      begin[i] = effort.begin + linkedEffort(patient_.links, i, from, from_speed);
      end[i] = effort.end + linkedEffort(patient_.links, i, to, to_speed);
      continue;
    }
    AxisDynamics& axis = held_[i] ? axes_[i] : bare_[i];
    axis.advance(effort);
    q_[i] = axis.position();
    qd_[i] = axis.velocity();
  }
  linked_.advance(begin, end, q_, qd_);
}

void SimulatedDevice::letPeriodPass() noexcept {
  letPersonAct();
  shiftDelayLine();
  AxisPosition aim;
  AxisVelocity aim_speed;
  player_->advance(period_s_, aim, aim_speed);
  q_intended_ = aim;
  for (int i = 0; i < q_.size(); ++i) {
    const Pull pull = pullOf(patient_.axes[i], q_[i], qd_[i], aim[i], aim_speed[i]);
    aim[i] = pull.q;
    aim_speed[i] = pull.qd;
  }
  moveAxes(aim, aim_speed);
  q_pull_ = aim;
  qd_pull_ = aim_speed;
}

Fault SimulatedDevice::read(DeviceReading& reading, int elapsed_periods) noexcept {
  if (!open_) return Fault::kDeviceRead;
  if (!std::exchange(fresh_, false)) {
    const int most = static_cast<int>(kLongestGap_s / period_s_);
    for (int i = 0; i < std::min(elapsed_periods, most); ++i) letPeriodPass();
  }
  reading.q_m = q_;
  for (int i = 0; i < q_.size(); ++i) {
    const double step = device_.axes[i].encoder_step;
    if (step > 0.0) reading.q_m[i] = step * std::round(q_[i] / step);
  }
  return Fault::kNone;
}

void SimulatedDevice::report(PersonReading& reading) const noexcept {
  if (!open_) return;
  reading.moved_by = player_->mover();
  reading.help = player_->help();
  reading.intention = q_intended_;
  reading.effort = impedance();
  for (int i = 0; i < q_.size(); ++i) reading.effort[i] += person_.end()[i];
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
