#include "devices/host/effort_guard.hpp"

#include "loop/safety/force_limiter.hpp"

#include <algorithm>
#include <iterator>

namespace wholehand {
namespace {

bool isNeutral(const AxisEffort& effort, const AxisEffort& neutral) noexcept {
  return std::equal(effort.begin(), effort.end(), neutral.begin(), neutral.end());
}

// Effort of the command, clamped; size 0 when the command is invalid.
AxisEffort effortOf(const HostCommand& command, const GuardConfig& config) noexcept {
  const int axes = config.neutral.size();
  if (command.axes != static_cast<std::uint64_t>(axes)) return AxisEffort(0);
  AxisEffort asked(axes);
  for (int i = 0; i < axes; ++i) asked[i] = command.effort[i];
  if (!allFinite(asked)) return AxisEffort(0);
  return limitEffort(asked, config.limit).effort;
}

// Takes the command if it is new. Returns why the loop must be ignored from now on; else kNone.
ReleaseReason receiveCommand(GuardState& s, const HostCommand* command, std::int64_t now_ns,
                             const GuardConfig& config, AxisEffort& wanted) noexcept {
  if (command == nullptr || command->session != s.session || command->sequence <= s.sequence) {
    return ReleaseReason::kNone;
  }
  s.sequence = command->sequence;
  s.last_command_ns = std::min(command->monotonic_ns, now_ns);
  s.phase = HostPhase::kRendering;
  wanted = effortOf(*command, config);
  return wanted.size() == 0 ? ReleaseReason::kBadCommand : ReleaseReason::kNone;
}

ReleaseReason checkSilence(const GuardState& s, std::int64_t now_ns) noexcept {
  const bool waits = s.phase == HostPhase::kWaiting;
  const std::int64_t patience_ns = waits ? kFirstCommand_ns : kLoopSilence_ns;
  if (now_ns - s.last_command_ns <= patience_ns) return ReleaseReason::kNone;
  return waits ? ReleaseReason::kNeverCommanded : ReleaseReason::kLoopSilent;
}

void letGo(GuardState& s, ReleaseReason why, const GuardConfig& config) noexcept {
  const bool neutral = isNeutral(s.ramp.sent, config.neutral);
  s.reason = why;
  if (neutral && why == ReleaseReason::kLoopSilent) s.reason = ReleaseReason::kSilentAtNeutral;
  // A loop that ended at neutral ended well, even if a late host must still bring the device there.
  const bool ended_well = why == ReleaseReason::kLoopEnded && isNeutral(s.wanted, config.neutral);
  if (ended_well) s.reason = ReleaseReason::kNone;
  s.phase = neutral ? HostPhase::kLatched : HostPhase::kRamping;
}

}  // namespace

wh_command neutralOf(const GuardConfig& config) noexcept {
  wh_command out{};
  out.size = sizeof(out);
  out.axes = static_cast<std::uint32_t>(config.neutral.size());
  std::copy(config.neutral.begin(), config.neutral.end(), std::begin(out.effort));
  return out;
}

GuardState beginSession(std::uint64_t session, std::int64_t now_ns,
                        const GuardConfig& config) noexcept {
  GuardState s;
  s.phase = HostPhase::kWaiting;
  s.session = session;
  s.last_command_ns = now_ns;
  s.wanted = config.neutral;
  s.ramp = engageFrom(config.neutral);
  s.ramp.again = true;  // fully engaged, because the loop blends in by itself
  s.ramp.authority = 1.0;
  s.given = SlewWindow(slewTicks(config.period_s));
  s.given.note(config.neutral);
  return s;
}

GuardState endSession(const GuardState& state, const GuardConfig& config) noexcept {
  GuardState s = state;
  s.phase = HostPhase::kIdle;
  s.ramp = engageFrom(config.neutral);
  return s;
}

GuardState advanceGuard(const GuardState& state, const HostCommand* command, ReleaseReason let_go,
                        int elapsed_periods, std::int64_t now_ns,
                        const GuardConfig& config) noexcept {
  GuardState next = state;
  if (state.phase == HostPhase::kIdle) return next;
  ReleaseReason why = ReleaseReason::kNone;
  if (state.phase == HostPhase::kWaiting || state.phase == HostPhase::kRendering) {
    AxisEffort wanted = state.wanted;
    why = let_go;
    if (why == ReleaseReason::kNone) why = receiveCommand(next, command, now_ns, config, wanted);
    if (why == ReleaseReason::kNone) why = checkSilence(next, now_ns);
    // The ramp begins at the effort that the device holds, not at a command that came too late.
    if (why == ReleaseReason::kNone) {
      next.wanted = wanted;
    } else {
      letGo(next, why, config);
    }
  }
  const StopAsked stop = why == ReleaseReason::kNone ? StopAsked::kNone : StopAsked::kPlain;
  next.ramp = advanceRamp(state.ramp, next.wanted, config.neutral, stop, elapsed_periods,
                          config.period_s, config.ramp);
  next.ramp.sent = limitSlew(next.ramp.sent, state.given, config.most_change).effort;
  next.given.note(next.ramp.sent);
  const bool neutral = isNeutral(next.ramp.sent, config.neutral);
  if (next.phase == HostPhase::kRamping && next.ramp.phase == RampPhase::kNeutral && neutral) {
    next.phase = HostPhase::kLatched;
  }
  return next;
}

}  // namespace wholehand
