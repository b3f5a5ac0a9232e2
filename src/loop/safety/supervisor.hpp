#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/fault.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"

#include <array>
#include <limits>

namespace wholehand {

/// Limits that the supervisor enforces, from the device file (docs/safety.md).
struct SupervisorConfig {
  int axes = 0;  ///< 0: no supervision
  double period_s = 1e-3;
  AxisPosition lower, upper;  ///< end of travel
  AxisPosition margin;        ///< a larger excursion beyond the range: kWorkspace
  AxisPosition encoder_step;
  AxisFlag carries;  ///< a base axis, which moves with the arm
  AxisVelocity speed_limit;
  AxisEffort effort_limit;
  AxisEffort most_change;  ///< largest change of effort within slew_ticks: the slew limit
  int slew_ticks = 1;  ///< periods in a millisecond, one at least (loop/safety/force_limiter.hpp)
  double power_limit_w = std::numeric_limits<double>::infinity();
  WatchLimits watch;  ///< 0: not watched
};

/// Limits of timing in force. A simulated device moves nobody: its late ticks and stuck encoders
/// are not watched, and it goes on after gaps of up to half a second.
[[nodiscard]] WatchLimits watchLimits(const DeviceModel& device, bool simulated);

[[nodiscard]] SupervisorConfig makeSupervisor(const DeviceModel& device, double period_s,
                                              bool simulated);

/// A fault and its axis (-1: no particular axis).
struct Finding {
  Fault faults = Fault::kNone;
  int axis = -1;
};

/// Gaps of more than 5 ms that are allowed in one second; one more stops the loop.
inline constexpr int kMostGaps = 3;

/// State of the device watch from tick to tick.
struct DeviceWatchState {
  bool fresh = true;  ///< no tick came before
  int late_in_a_row = 0;
  std::array<double, kMostGaps> since_gap_s{9.0, 9.0, 9.0};  ///< newest first; 9 s: none yet
  std::array<int, kMaxAxes> fast_ticks{};  ///< consecutive ticks beyond the speed limit
  AxisPosition q;         ///< position at the last tick; before the first tick, at arming
  AxisPosition still_at;  ///< position at which an axis has stood still
  std::array<double, kMaxAxes> still_s{};           ///< for how long
  std::array<double, kMaxAxes> travelled_before{};  ///< `travelled` when the standstill began
  AxisEffort least, most;                           ///< smallest and largest effort sent since then
  double travelled = 0.0;  ///< sum of all base axes' travel, in fractions of their ranges
};

/// Checks the device's reading, before anything is computed from it:
///   kSpeedLimit    |Δq| > q̇_max kT + 2δ, in two consecutive ticks: a reading may be late,
///                  and the next is early then. In the first tick: more than a twentieth of the
///                  range from where it was armed, at rest
///   kEncoderJump   |Δq| > 3 q̇_max kT + 2δ: no hand moves so
///   kWorkspace     beyond the range by more than the margin
///   kEncoderStuck  within a count and a half for stuck_encoder_s, not at a stop, while the axis's
///                  own effort changed by a fifth of its limit or, on a base axis, the others
///                  travelled five ranges. Fingers may rest while the arm moves, and an arm while
///                  the fingers do: neither is evidence
///   kLateInARow    late ticks in a row, or more than three gaps of over 5 ms in any second
///   kLongGap       a gap longer than is allowed
///
/// A fault that is not of timing names the first axis. Real-time safe.
/// @param sent the last effort sent
[[nodiscard]] WHOLEHAND_RT Finding watchDevice(DeviceWatchState& state, const AxisPosition& q_m,
                                               const AxisEffort& sent, int elapsed_periods,
                                               const SupervisorConfig& config) noexcept;

/// State of the avatar watch from tick to tick.
struct AvatarWatchState {
  double catch_up_left_s = 0.0;  ///< the hand still catches up after a stall
};

/// kBodiesExploded when the simulated hand is ten times as fast as the device may be: ten times
/// what contact within the limits can cause. When gaps are only counted, the check pauses for 0.2 s
/// after a gap of more than 5 periods, in which the simulated hand catches up with the device.
/// Real-time safe.
[[nodiscard]] WHOLEHAND_RT Fault watchAvatar(AvatarWatchState& state, const TickRecord& observed,
                                             const SupervisorConfig& config) noexcept;

/// Computes the state after a tick. Real-time safe.
/// @param latched stopping faults of this run so far @param at_neutral after a stop or a fault
[[nodiscard]] WHOLEHAND_RT SafetyState nextSafetyState(SafetyState state, Fault latched,
                                                       bool at_neutral, double authority) noexcept;

}  // namespace wholehand
