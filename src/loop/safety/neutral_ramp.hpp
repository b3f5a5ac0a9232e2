#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"

namespace wholehand {

/// Longest ramp to neutral after a fault [s]. A configuration cannot extend it.
inline constexpr double kLongestRamp_s = 0.1;

struct NeutralRampConfig {
  /// Authority rises from 0 to 1 at the start. Range [0.02, 5]. Our own choice.
  double engage_s = 0.2;
  double ramp_s = 0.08;  ///< from a fault to neutral. Range (0, 0.1]: 100 ms minus a reserve.
  /// Added to ramp_s at a gentle stop, while the exercise fades out. Range [0, 5].
  double fade_out_s = 0.0;
  double gap_s = 0.005;  ///< after a longer stall the effort is blended in again from the held
                         ///< effort. Our own choice.
  /// Duration of blending in after a stall. The held effort does not react to the person meanwhile.
  /// At 0.2 s, a stall of 6 ms every 0.1 s kept a certified loop oscillating; at 0.03 s no such
  /// stall does.
  double reengage_s = 0.03;
};

enum class RampPhase {
  kRendering,  ///< engaging, engaged, or letting go gently
  kRamping,    ///< from the last good effort to neutral
  kNeutral     ///< the end; only arming leaves this phase
};

/// State of the blend between rendered and neutral effort. An effort that drops to zero suddenly
/// could let a patient's arm fall; a step at the start could frighten a patient.
struct NeutralRampState {
  RampPhase phase = RampPhase::kNeutral;
  double authority = 0.0;  ///< share of the rendered effort that is sent, 0 .. 1
  double elapsed_s = 0.0;  ///< time in this phase; while rendering, time since the blend began
  double authority_at_stop = 0.0;
  /// Blending in again after a stall; the effort had been fully blended in before.
  bool again = false;
  double again_s = 0.0;  ///< duration of that second blend
  AxisEffort held;       ///< effort at the start of engaging or ramping
  AxisEffort sent;       ///< effort to send to the device
  bool gentle = false;   ///< a gentle stop was requested
  double since_gentle_stop_s = 0.0;
  AxisEffort at_gentle_stop;  ///< effort sent before the gentle stop
};

/// The requested stop: kPlain ramps to neutral at once, kGentle lets the effort fall slowly first.
enum class StopAsked { kNone, kGentle, kPlain };

/// State before the first tick: the device holds its neutral effort.
[[nodiscard]] WHOLEHAND_RT NeutralRampState engageFrom(const AxisEffort& neutral) noexcept;

/// Advances by one tick. While rendering, sent = held + authority (wanted − held). Authority rises
/// smoothly from 0 to 1 over engage_s, by one period per tick; held is the neutral effort at the
/// start. After a stall of more than gap_s the device has moved on and the simulated hand has not,
/// so the wanted effort jumps. The blend then starts again from the effort that the device held.
///
/// From the tick of a stop on, sent = neutral + s (held − neutral). held is the last effort sent; s
/// falls from 1 to 0 by a smoothstep over ramp_s of elapsed time. The first tick counts as one
/// period, since the stop was unknown before it. The result is continuous, monotonic on every axis,
/// exactly neutral at the end, and never rises again. `wanted` is ignored. A wanted effort that is
/// not finite counts as a plain stop.
///
/// From the tick of a gentle stop on, rendering continues below a bound that only falls: the effort
/// of each axis stays between neutral and neutral + s (sent − neutral), with `sent` the effort
/// before the stop. s falls from 1 to 0 by a smoothstep over fade_out_s + ramp_s. The hand
/// therefore still yields to the person, and at the end the device is at neutral. A ramp that
/// begins meanwhile stays below that bound. Pure, real-time safe.
/// @param wanted effort within the device's limits (limitEffort); every effort sent is then within
/// them too
/// @param elapsed_periods 1 + skipped periods
[[nodiscard]] WHOLEHAND_RT NeutralRampState advanceRamp(const NeutralRampState& state,
                                                        const AxisEffort& wanted,
                                                        const AxisEffort& neutral, StopAsked stop,
                                                        int elapsed_periods, double period_s,
                                                        const NeutralRampConfig& config) noexcept;

}  // namespace wholehand
