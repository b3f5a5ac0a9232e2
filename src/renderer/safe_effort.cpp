// From what is to be felt to what the device holds, and what the supervisor makes of the tick.
#include "renderer/effort_sum.hpp"
#include "renderer/haptic_renderer.hpp"
#include "renderer/note_fault.hpp"
#include "safety/force_limiter.hpp"
#include "safety/power_limiter.hpp"
#include "safety/slew_limiter.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

AxisEffort noted(const LimitedEffort& limited, TickRecord& record) noexcept {
  noteFault(limited.faults, limited.axis, record);
  return limited.effort;
}

// What is rendered, within the limits that are tighter than the device's.
AxisEffort heldTo(const AxisEffort& limit, const AxisEffort& device_limit,
                  TickRecord& record) noexcept {
  AxisEffort out = record.rendered;
  for (int i = 0; i < out.size(); ++i) {
    if (!(limit[i] < device_limit[i]) || !(std::abs(out[i]) > limit[i])) continue;
    out[i] = std::clamp(out[i], -limit[i], limit[i]);
    noteFault(Fault::kEffortLimit, i, record);
  }
  return out;
}

// What the walls of an exercise hold: half their effort times the depth in them, with a bounded
// part of the damping's that comes and goes with the motion.
AxisEnergy wallStored(const TickRecord& record) noexcept {
  const ExerciseRecord& exercise = record.exercise;
  AxisEnergy out(exercise.wall_active.size());
  for (int i = 0; i < out.size(); ++i) {
    if (exercise.wall_active[i] == 0.0) continue;
    out[i] = 0.5 * std::abs(exercise.effort[i] * (record.q_m[i] - exercise.wall[i]));
  }
  return out;
}

}  // namespace

void HapticRenderer::watchEnergy(std::uint32_t elapsed_periods, TickRecord& record) noexcept {
  record.tank_effort = AxisEffort(config_.gains.axes);
  record.tank = tank_.energy;
  if (config_.tank.axes == 0 || any(record.faults & kStopping)) return;
  const EnergyTankStep step =
      advanceTank(tank_, record.q_m, record.q_s, wallStored(record), config_.gains, config_.tank,
                  effort_limit_, static_cast<int>(elapsed_periods), config_.period_s);
  tank_ = step.state;
  record.tank = tank_.energy;
  // While an effort is blended in, the springs hold what nobody was given yet: nothing to judge.
  if (ramp_.authority < 1.0) return;
  record.tank_effort = step.effort;
  for (int i = 0; i < step.effort.size(); ++i) {
    if (step.effort[i] != 0.0) noteFault(Fault::kTankEmpty, i, record);
  }
}

void HapticRenderer::makeSafe(std::uint32_t elapsed_periods, TickRecord& record) noexcept {
  watchEnergy(elapsed_periods, record);
  record.rendered =
      sum(sum(sum(record.coupling, record.exercise.effort), record.damping), record.tank_effort);
  const AxisEffort wanted = withinEffort(record);
  latched_ |= record.faults & kStopping;
  // The emergency first: who presses counts the stop first, so that none is seen without the other.
  const bool emergency = emergencies_.load(std::memory_order_seq_cst) != emergencies_armed_;
  stops_seen_ = stops_.load(std::memory_order_seq_cst);
  const bool asked = emergency || stops_seen_ != stops_armed_;
  if (asked) record.faults |= Fault::kStopRequested;
  if (emergency) record.faults |= Fault::kEmergencyStop;
  if (!owner_alive_) record.faults |= Fault::kOwnerSilent;
  slew_.note(ramp_.sent);
  ramp_ = advanceRamp(ramp_, wanted, config_.neutral, any(latched_) || asked,
                      static_cast<int>(elapsed_periods), config_.period_s, config_.ramp);
  if (ramp_.phase == RampPhase::kRendering) {  // a ramp only ever falls, and knows no good velocity
    ramp_.sent = noted(
        limitPower(ramp_.sent, config_.neutral, record.qd_mf, config_.supervisor.power_limit_w),
        record);
  }
  if (config_.supervisor.axes > 0) {
    ramp_.sent = noted(limitSlew(ramp_.sent, slew_, config_.supervisor.most_change), record);
  }
  record.authority = ramp_.authority;
  record.sent = ramp_.sent;
  if (config_.tank.axes == 0) return;
  tank_ = noteSent(tank_, difference(record.sent, config_.neutral), record.f_s, effort_limit_);
  if (ramp_.authority < 1.0) {
    tank_.energy = config_.tank.capacity;
    tank_.hand = config_.tank.hand_capacity;
  }
}

// What may be sent of what is rendered. A therapist's limit is on what is rendered; the device's
// own on all that is sent, the effort that carries its weight with it.
AxisEffort HapticRenderer::withinEffort(TickRecord& record) const noexcept {
  const AxisEffort held = heldTo(effort_limit_, config_.effort_limit, record);
  return noted(limitEffort(sum(held, config_.neutral), config_.effort_limit), record);
}

void HapticRenderer::writeDevice(TickRecord& record) noexcept {
  const Fault fault = device_.write(record.sent);
  noteFault(fault, -1, record);
  latched_ |= fault & kStopping;
  if (!any(fault & Fault::kDeviceWrite)) {
    acknowledged_ = record.sent;
    return;
  }
  // It goes on with what it holds: the ramp, the slew limit and the record go by that.
  ramp_.sent = record.sent = acknowledged_;
  if (ramp_.phase == RampPhase::kNeutral) unconfirmed_s_ += config_.period_s;
}

// Last in the tick: a device that refused the effort or a world that could not step has faulted it.
void HapticRenderer::concludeSafety(TickRecord& record) noexcept {
  safety_state_ = nextSafetyState(safety_state_, latched_, atNeutral(), ramp_.authority);
  record.safety_state = safety_state_;
}

}  // namespace wholehand
