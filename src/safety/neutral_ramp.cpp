#include "safety/neutral_ramp.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

namespace {

/// 3u² − 2u³ of u = elapsed / duration, 0 .. 1; 1 when the duration is 0.
double smoothstep(double elapsed_s, double duration_s) noexcept {
  if (!(elapsed_s < duration_s)) return 1.0;
  const double u = elapsed_s / duration_s;
  return std::min(u * u * (3.0 - 2.0 * u), 1.0);
}

/// lerp is exact at both ends and monotonic; a + s (b − a) is not.
AxisEffort blend(const AxisEffort& neutral, const AxisEffort& effort, double share) noexcept {
  AxisEffort out(neutral.size());
  for (int i = 0; i < neutral.size(); ++i) out[i] = std::lerp(neutral[i], effort[i], share);
  return out;
}

void engageAnew(NeutralRampState& s) noexcept {
  s.held = s.sent;
  s.elapsed_s = 0.0;
  s.again = s.again || s.authority >= 1.0;
}

void render(NeutralRampState& s, const AxisEffort& wanted, double period_s,
            double engage_s) noexcept {
  s.elapsed_s += period_s;
  s.authority = smoothstep(s.elapsed_s, engage_s);
  s.sent = blend(s.held, wanted, s.authority);
}

void ramp(NeutralRampState& s, const AxisEffort& neutral, double elapsed_s,
          double ramp_s) noexcept {
  s.elapsed_s += elapsed_s;
  const double duration_s = ramp_s > 0.0 ? std::min(ramp_s, kLongestRamp_s) : kLongestRamp_s;
  const double share = 1.0 - smoothstep(s.elapsed_s, duration_s);
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
                             const AxisEffort& neutral, bool stop, int elapsed_periods,
                             double period_s, const NeutralRampConfig& config) noexcept {
  NeutralRampState next = state;
  double elapsed_s = std::max(elapsed_periods, 1) * period_s;
  const bool usable = wanted.size() == neutral.size() && allFinite(wanted);
  if (state.phase == RampPhase::kRendering && (stop || !usable)) {
    next.phase = RampPhase::kRamping;
    next.held = state.sent;
    next.authority_at_stop = state.authority;
    next.elapsed_s = 0.0;
    elapsed_s = period_s;
  }
  switch (next.phase) {
    case RampPhase::kRendering:
      if (elapsed_s > config.gap_s) engageAnew(next);
      render(next, wanted, period_s, next.again ? config.reengage_s : config.engage_s);
      break;
    case RampPhase::kRamping:
      ramp(next, neutral, elapsed_s, config.ramp_s);
      break;
    case RampPhase::kNeutral:
      next.authority = 0.0;
      next.sent = neutral;
      break;
  }
  return next;
}

}  // namespace wholehand
