#include "loop/safety/neutral_ramp.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {

namespace {

/// 3u² − 2u³ of u = elapsed / duration, 0 .. 1; 1 when the duration is 0.
double smoothstep(double elapsed_s, double duration_s) noexcept {
  if (!(elapsed_s < duration_s)) return 1.0;
  const double u = elapsed_s / duration_s;
  return std::min(u * u * (3.0 - 2.0 * u), 1.0);
}

/// Blends neutral and effort. std::lerp is exact at both ends and monotonic; a + s (b − a) is not.
AxisEffort blend(const AxisEffort& neutral, const AxisEffort& effort, double share) noexcept {
  AxisEffort out(neutral.size());
  for (int i = 0; i < neutral.size(); ++i) out[i] = std::lerp(neutral[i], effort[i], share);
  return out;
}

void engageAnew(NeutralRampState& s, double reengage_s) noexcept {
  s.held = s.sent;
  s.elapsed_s = 0.0;
  s.again = s.again || s.authority >= 1.0;
  s.again_s = reengage_s;
}

void render(NeutralRampState& s, const AxisEffort& wanted, double period_s,
            double engage_s) noexcept {
  s.elapsed_s += period_s;
  s.authority = smoothstep(s.elapsed_s, engage_s);
  s.sent = blend(s.held, wanted, s.authority);
}

double rampTime_s(const NeutralRampConfig& config) noexcept {
  return config.ramp_s > 0.0 ? std::min(config.ramp_s, kLongestRamp_s) : kLongestRamp_s;
}

// Bounds each axis between neutral and the remaining share of its effort at the gentle stop.
void letGo(NeutralRampState& s, const AxisEffort& neutral, double elapsed_s,
           const NeutralRampConfig& config) noexcept {
  s.since_gentle_stop_s += elapsed_s;
  const double duration_s = std::max(config.fade_out_s, 0.0) + rampTime_s(config);
  const double share = 1.0 - smoothstep(s.since_gentle_stop_s, duration_s);
  const AxisEffort bound = blend(neutral, s.at_gentle_stop, share);
  for (int i = 0; i < neutral.size(); ++i) {
    s.sent[i] =
        std::clamp(s.sent[i], std::min(neutral[i], bound[i]), std::max(neutral[i], bound[i]));
  }
  s.authority = std::min(s.authority, share);
  if (share == 0.0) s.phase = RampPhase::kNeutral;
}

void ramp(NeutralRampState& s, const AxisEffort& neutral, double elapsed_s,
          double ramp_s) noexcept {
  s.elapsed_s += elapsed_s;
  const double share = 1.0 - smoothstep(s.elapsed_s, ramp_s);
  s.authority = share * s.authority_at_stop;
  s.sent = blend(neutral, s.held, share);
  if (share == 0.0) s.phase = RampPhase::kNeutral;
}

}  // namespace

NeutralRampState engageFrom(const AxisEffort& neutral) noexcept {
  NeutralRampState s;
  s.phase = RampPhase::kRendering;
  s.held = neutral;
  s.sent = neutral;
  return s;
}

NeutralRampState advanceRamp(const NeutralRampState& state, const AxisEffort& wanted,
                             const AxisEffort& neutral, StopAsked stop, int elapsed_periods,
                             double period_s, const NeutralRampConfig& config) noexcept {
  NeutralRampState next = state;
  const double elapsed_s = std::max(elapsed_periods, 1) * period_s;
  // The tick that sees a stop counts as one period of that stop.
  double of_ramp_s = elapsed_s, of_gentle_stop_s = elapsed_s;
  const bool usable = wanted.size() == neutral.size() && allFinite(wanted);
  if (state.phase == RampPhase::kRendering && (stop == StopAsked::kPlain || !usable)) {
    next.phase = RampPhase::kRamping;
    next.held = state.sent;
    next.authority_at_stop = state.authority;
    next.elapsed_s = 0.0;
    of_ramp_s = period_s;
  }
  // Advances the present phase.
  switch (next.phase) {
    case RampPhase::kRendering:
      if (elapsed_periods > 1 && elapsed_s > config.gap_s) engageAnew(next, config.reengage_s);
      render(next, wanted, period_s, next.again ? next.again_s : config.engage_s);
      if (stop == StopAsked::kGentle && !std::exchange(next.gentle, true)) {
        next.at_gentle_stop = state.sent;
        of_gentle_stop_s = period_s;
      }
      break;
    case RampPhase::kRamping:
      ramp(next, neutral, of_ramp_s, rampTime_s(config));
      break;
    case RampPhase::kNeutral:
      next.authority = 0.0;
      next.sent = neutral;
      break;
  }
  if (next.gentle && next.phase != RampPhase::kNeutral) {
    letGo(next, neutral, of_gentle_stop_s, config);
  }
  return next;
}

}  // namespace wholehand
