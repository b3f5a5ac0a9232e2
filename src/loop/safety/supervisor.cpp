#include "loop/safety/supervisor.hpp"

#include "loop/safety/force_limiter.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kJump = 3.0;    // kEncoderJump: multiple of the speed limit
constexpr double kCounts = 2.0;  // encoder counts between two readings of one motion
// Encoder counts: a broken encoder may alternate between two values.
constexpr double kStillCounts = 1.5;
// Two readings, each up to kCounts wrong, of an axis that did not move; farther away is a spike.
constexpr double kSpikeCounts = 2.0 * kCounts;
constexpr double kTravel = 5.0;  // travel of the other axes, in ranges, while an encoder is
                                 // stuck
// change of the axis's own effort meanwhile, as a fraction of its limit
constexpr double kEffortOfLimit = 0.2;
constexpr double kAvatarSpeed = 10.0;  // multiple of the device's speed limit
constexpr int kFastTicks = 2;          // consecutive ticks beyond the speed limit
// Largest motion between arming and the first tick, as a fraction of the range.
constexpr double kMovedOfRange = 0.05;
constexpr double kGap_s = 0.005;       // longer gaps blend the effort in again
constexpr double kGapsWithin_s = 1.0;  // window for counting gaps
// After a gap of more than kStall_periods that is only counted, watchAvatar() pauses for
// kCatchUp_s.
constexpr std::uint32_t kStall_periods = 5;
constexpr double kCatchUp_s = 0.2;
constexpr double kLongestSimulatedGap_s = 0.5;  // longest gap of a simulated device

void add(Finding& finding, Fault fault, int axis) noexcept {
  if (finding.axis < 0) finding.axis = axis;
  finding.faults |= fault;
}

void watchTiming(DeviceWatchState& state, int elapsed_periods, const SupervisorConfig& config,
                 Finding& finding) noexcept {
  state.late_in_a_row = elapsed_periods > 1 ? state.late_in_a_row + 1 : 0;
  const WatchLimits& watch = config.watch;
  if (watch.late_in_a_row > 0 && state.late_in_a_row > watch.late_in_a_row) {
    finding.faults |= Fault::kLateInARow;
  }
  const double elapsed_s = elapsed_periods * config.period_s;
  for (double& since_s : state.since_gap_s) since_s += elapsed_s;
  if (elapsed_periods > 1 && elapsed_s > kGap_s) {
    const bool one_more = state.since_gap_s.back() < kGapsWithin_s;
    if (watch.late_in_a_row > 0 && one_more) finding.faults |= Fault::kLateInARow;
    std::shift_right(state.since_gap_s.begin(), state.since_gap_s.end(), 1);
    state.since_gap_s.front() = 0.0;
  }
  if (watch.longest_gap_s > 0.0 && elapsed_s > watch.longest_gap_s) {
    finding.faults |= Fault::kLongGap;
  }
}

void watchMotion(DeviceWatchState& state, const AxisPosition& q_m, double elapsed_s,
                 const SupervisorConfig& config, Finding& finding) noexcept {
  for (int i = 0; i < config.axes; ++i) {
    const double moved = std::abs(q_m[i] - state.q[i]) - kCounts * config.encoder_step[i];
    const double allowed = config.speed_limit[i] * elapsed_s;
    int& fast = state.fast_ticks[i];
    fast = moved <= allowed ? 0 : fast + 1;
    if (!(moved <= kJump * allowed)) {
      add(finding, Fault::kEncoderJump, i);
    } else if (fast >= kFastTicks) {
      add(finding, Fault::kSpeedLimit, i);
    }
  }
}

// The simulated hand is placed at the device's position at arming. Only that position was checked
// for obstacles, so the device must still be there.
void watchArmed(const AxisPosition& armed, const AxisPosition& q_m, const SupervisorConfig& config,
                Finding& finding) noexcept {
  for (int i = 0; i < armed.size(); ++i) {
    const double allowed = kMovedOfRange * (config.upper[i] - config.lower[i]);
    if (!(std::abs(q_m[i] - armed[i]) <= allowed + kCounts * config.encoder_step[i])) {
      add(finding, Fault::kSpeedLimit, i);
    }
  }
}

bool atStop(double q, int axis, const SupervisorConfig& config) noexcept {
  return q <= config.lower[axis] + config.margin[axis] ||
         q >= config.upper[axis] - config.margin[axis];
}

void watchStuck(DeviceWatchState& state, const AxisPosition& q_m, const AxisEffort& sent,
                double elapsed_s, const SupervisorConfig& config, Finding& finding) noexcept {
  for (int i = 0; i < config.axes; ++i) {
    if (!config.carries[i]) continue;
    state.travelled += std::abs(q_m[i] - state.q[i]) / (config.upper[i] - config.lower[i]);
  }
  for (int i = 0; i < config.axes; ++i) {
    const double moved = std::abs(q_m[i] - state.still_at[i]);
    if (moved > kStillCounts * config.encoder_step[i] || atStop(q_m[i], i, config)) {
      state.spiked[i] = moved > kSpikeCounts * config.encoder_step[i] && state.still_s[i] == 0.0 &&
                        std::abs(q_m[i] - state.left[i]) <= kStillCounts * config.encoder_step[i];
      state.left[i] = state.still_at[i];
      state.still_at[i] = q_m[i];
      state.still_s[i] = 0.0;
      state.travelled_before[i] = state.travelled;
      state.least[i] = state.most[i] = sent[i];
      continue;
    }
    state.still_s[i] += elapsed_s;
    state.least[i] = std::min(state.least[i], sent[i]);
    state.most[i] = std::max(state.most[i], sent[i]);
    const bool arm_moved =
        config.carries[i] && state.travelled - state.travelled_before[i] > kTravel;
    const bool should_move =
        arm_moved || state.most[i] - state.least[i] > kEffortOfLimit * config.effort_limit[i];
    if (state.still_s[i] < config.watch.stuck_encoder_s) continue;
    if (!should_move) {
      state.spiked[i] = false;  // what the effort does from now on has another cause
      continue;
    }
    const bool by_spike = state.spiked[i] && !arm_moved;
    add(finding, by_spike ? Fault::kEncoderJump : Fault::kEncoderStuck, i);
  }
}

}  // namespace

WatchLimits watchLimits(const DeviceModel& device, bool simulated) {
  if (!simulated) return device.watch;
  WatchLimits limits;
  limits.longest_gap_s = kLongestSimulatedGap_s;
  return limits;
}

SupervisorConfig makeSupervisor(const DeviceModel& device, double period_s, bool simulated) {
  SupervisorConfig config;
  config.axes = device.axisCount();
  config.period_s = period_s;
  config.power_limit_w = device.power_limit_w;
  config.watch = watchLimits(device, simulated);
  config.lower = config.upper = config.margin = config.encoder_step = AxisPosition(config.axes);
  config.carries = AxisFlag(config.axes);
  config.speed_limit = AxisVelocity(config.axes);
  config.slew_ticks = slewTicks(period_s);
  config.effort_limit = config.most_change = AxisEffort(config.axes);
  for (int i = 0; i < config.axes; ++i) {
    const DeviceAxis& axis = device.axes[i];
    config.lower[i] = axis.lower;
    config.upper[i] = axis.upper;
    config.margin[i] = axis.workspace_margin;
    config.encoder_step[i] = axis.encoder_step;
    config.carries[i] = axis.group == AxisGroup::kBase;
    config.speed_limit[i] = axis.speed_limit;
    config.effort_limit[i] = axis.effort_limit;
    config.most_change[i] = axis.effort_slew_limit * config.slew_ticks * period_s;
  }
  return config;
}

Finding watchDevice(DeviceWatchState& state, const AxisPosition& q_m, const AxisEffort& sent,
                    int elapsed_periods, const SupervisorConfig& config) noexcept {
  Finding finding;
  if (config.axes == 0) return finding;
  for (int i = 0; i < config.axes; ++i) {
    if (!(q_m[i] >= config.lower[i] - config.margin[i] &&
          q_m[i] <= config.upper[i] + config.margin[i])) {
      add(finding, Fault::kWorkspace, i);
    }
  }
  if (state.fresh) {
    watchArmed(state.q, q_m, config, finding);
    state = DeviceWatchState{};
    state.fresh = false;
    state.still_at = state.left = q_m;
    state.least = state.most = sent;
  } else {
    const double elapsed_s = elapsed_periods * config.period_s;
    watchTiming(state, elapsed_periods, config, finding);
    watchMotion(state, q_m, elapsed_s, config, finding);
    if (config.watch.stuck_encoder_s > 0.0) {
      watchStuck(state, q_m, sent, elapsed_s, config, finding);
    }
  }
  state.q = q_m;
  return finding;
}

Fault watchAvatar(AvatarWatchState& state, const TickRecord& observed,
                  const SupervisorConfig& config) noexcept {
  if (config.axes == 0) return Fault::kNone;
  const bool stalled = config.watch.late_in_a_row <= 0 && observed.elapsed_periods > kStall_periods;
  state.catch_up_left_s = stalled ? kCatchUp_s : state.catch_up_left_s - config.period_s;
  Fault fault = Fault::kNone;
  for (int i = 0; i < config.axes; ++i) {
    if (!(std::abs(observed.qd_s[i]) <= kAvatarSpeed * config.speed_limit[i])) {
      fault = Fault::kBodiesExploded;
    }
  }
  return state.catch_up_left_s > 0.0 ? Fault::kNone : fault;
}

SafetyState nextSafetyState(SafetyState state, Fault latched, bool at_neutral,
                            double authority) noexcept {
  if (any(latched)) return SafetyState::kFaulted;
  if (at_neutral) return SafetyState::kDisarmed;
  if (state == SafetyState::kArmed && authority >= 1.0) return SafetyState::kRendering;
  return state;
}

}  // namespace wholehand
