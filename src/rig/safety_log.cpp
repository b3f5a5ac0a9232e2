#include "rig/safety_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wholehand {

std::string describe(const SafetyTransition& t) {
  return fmt::format("{:8.3f} s  {} -> {}: {}", t.time_s, nameOf(t.from), nameOf(t.to), t.cause);
}

SafetyLog::SafetyLog(DeviceModel device, double period_s,
                     std::function<void(const SafetyTransition&)> on_transition)
    : device_(std::move(device)), period_s_(period_s), on_transition_(std::move(on_transition)) {}

void SafetyLog::beginSession() {
  const std::lock_guard lock(mutex_);
  transitions_.clear();
  known_ = false;
  stop_asked_s_ = -1.0;
}

void SafetyLog::add(const TickRecord& record) {
  if (known_ && record.tick <= last_tick_) beginSession();
  if (any(record.faults & Fault::kStopRequested) && stop_asked_s_ < 0.0) {
    stop_asked_s_ = record.time_s;
  }
  if (record.safety_state != state()) {
    const SafetyTransition transition = transitionAt(record);
    {
      const std::lock_guard lock(mutex_);
      state_ = transition.to;
      transitions_.push_back(transition);
    }
    if (on_transition_) on_transition_(transition);
  }
  known_ = true;
  last_tick_ = record.tick;
  last_q_m_ = record.q_m;
}

SafetyTransition SafetyLog::transitionAt(const TickRecord& record) const {
  SafetyTransition out;
  out.tick = record.tick;
  out.time_s = record.time_s;
  out.from = state();
  out.to = record.safety_state;
  switch (out.to) {
    case SafetyState::kArmed:
      out.cause = "every check of arming passed";
      break;
    case SafetyState::kRendering:
      out.cause = "the effort is blended in";
      break;
    case SafetyState::kDisarmed: {
      out.faults = record.faults & (Fault::kEmergencyStop | Fault::kStopRequested);
      const bool emergency = any(out.faults & Fault::kEmergencyStop);
      out.cause = fmt::format("{} at {:.3f} s, at neutral now",
                              emergency ? "emergency stop" : "stop requested",
                              stop_asked_s_ < 0.0 ? record.time_s : stop_asked_s_);
      break;
    }
    case SafetyState::kFaulted:
      nameFault(record, out);
      break;
  }
  return out;
}

void SafetyLog::nameFault(const TickRecord& record, SafetyTransition& out) const {
  out.faults = record.faults & kStoppingFaults;
  out.cause = any(out.faults) ? faultNames(out.faults) : "a fault whose record was dropped";
  const bool of_axis = record.fault_axis >= 0 && record.fault_axis < device_.axisCount();
  if (of_axis) {
    out.axis = record.fault_axis;
    out.cause += " on " + device_.axes[out.axis].name;
  }
  if (!known_ && any(out.faults & Fault::kSpeedLimit)) out.cause += " since it was armed";
  measure(record, out);
  if (out.limit != 0.0) {
    out.cause += fmt::format(", {:.3g} {} of {:.3g}", out.value, out.unit, out.limit);
  }
}

// Fills in the value and its limit if the record contains them.
void SafetyLog::measure(const TickRecord& record, SafetyTransition& out) const {
  const double elapsed_s = static_cast<double>(record.elapsed_periods) * period_s_;
  if (any(out.faults & Fault::kLongGap)) {
    out.value = elapsed_s;
    out.limit = device_.watch.longest_gap_s;
    out.unit = "s";
  }
  if (out.axis < 0 || out.axis >= record.q_m.size()) return;
  const DeviceAxis& axis = device_.axes[out.axis];
  const bool follows = known_ && last_tick_ + record.elapsed_periods == record.tick &&
                       last_q_m_.size() == record.q_m.size();
  if (any(out.faults & Fault::kWorkspace)) {
    out.value = record.q_m[out.axis];
    out.limit = out.value > axis.upper ? axis.upper + axis.workspace_margin
                                       : axis.lower - axis.workspace_margin;
    out.unit = axis.positionUnit();
  } else if (any(out.faults & (Fault::kSpeedLimit | Fault::kEncoderJump)) && follows) {
    const double speed = std::abs(record.q_m[out.axis] - last_q_m_[out.axis]) / elapsed_s;
    if (speed <= axis.speed_limit) return;  // a spike, judged when it was over
    out.value = speed;
    out.limit = axis.speed_limit;
    out.unit = std::string(axis.positionUnit()) + "/s";
  }
}

SafetyState SafetyLog::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

std::vector<SafetyTransition> SafetyLog::transitions() const {
  const std::lock_guard lock(mutex_);
  return transitions_;
}

SafetyTransition SafetyLog::fault() const {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(transitions_.begin(), transitions_.end(),
                                  [](const auto& t) { return t.to == SafetyState::kFaulted; });
  return found == transitions_.end() ? SafetyTransition{} : *found;
}

}  // namespace wholehand
