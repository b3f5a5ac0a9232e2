#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// The longest a ramp to neutral may take after a fault [s]; a configuration cannot lengthen it.
inline constexpr double kLongestRamp_s = 0.1;

struct NeutralRampConfig {
  double engage_s = 0.2;  ///< authority rises from 0 to 1 at the start. Range [0.02, 5]. Ours.
  double ramp_s = 0.08;   ///< from a fault to neutral. Range (0, 0.1]. 100 ms, less slack.
  double gap_s = 0.005;   ///< a stall longer than this engages anew from the effort it held. Ours.
  /// Duration of that engagement. The effort that is held meanwhile does not react to the person:
  /// at 0.2 s a stall of 6 ms every 0.1 s kept a certified loop swinging, at 0.03 s none does.
  double reengage_s = 0.03;
};

enum class RampPhase {
  kRendering,  ///< engaging, or engaged
  kRamping,    ///< on the way from the last good effort to neutral
  kNeutral     ///< the end: only a new start leaves it
};

/// State of the blend between the rendered effort and the neutral effort. A sudden zero may drop a
/// patient's arm; a step at the start may frighten a patient.
struct NeutralRampState {
  RampPhase phase = RampPhase::kNeutral;
  double authority = 0.0;  ///< share of the rendered effort that is sent, 0 .. 1
  double elapsed_s = 0.0;  ///< in this phase; while rendering, since it was engaged
  double authority_at_stop = 0.0;
  bool again = false;  ///< engaged anew after a stall, having been engaged wholly
  AxisEffort held;     ///< what engaging or ramping began from
  AxisEffort sent;     ///< what the device is to receive
};

/// Before the first tick: the device holds its neutral effort.
[[nodiscard]] WHOLEHAND_RT NeutralRampState engageFrom(const AxisEffort& neutral) noexcept;

/// One tick. Rendering: sent = held + authority (wanted − held), authority rising smoothly from 0
/// to 1 over engage_s by one period a tick; held is neutral at the start. After a stall of more
/// than gap_s the device has moved on and the simulated hand has not, so that what is wanted jumps:
/// it engages anew from the effort that the device held. From the tick of a stop on: sent = neutral
/// + s (held − neutral), held the last effort sent, s falling from 1 to 0 by a smoothstep over
/// ramp_s of elapsed time, the first tick counting as one period (the stop was not known before
/// it): continuous, monotone on every axis, exactly neutral at the end, never upwards again.
/// `wanted` is not looked at then. A wanted effort that is not finite counts as a stop. Pure,
/// real-time safe.
/// @param wanted within the device's limits (limitEffort); so is, then, whatever is sent
/// @param elapsed_periods 1 + skipped periods
[[nodiscard]] WHOLEHAND_RT NeutralRampState advanceRamp(const NeutralRampState& state,
                                                        const AxisEffort& wanted,
                                                        const AxisEffort& neutral, bool stop,
                                                        int elapsed_periods, double period_s,
                                                        const NeutralRampConfig& config) noexcept;

}  // namespace wholehand
