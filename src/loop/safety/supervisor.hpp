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
  AxisFlag carries;  ///< true for a base axis, which moves with the arm
  AxisVelocity speed_limit;
  AxisEffort effort_limit;
  AxisEffort most_change;  ///< largest change of effort within slew_ticks, from the slew limit
  /// Number of periods in a millisecond, at least 1 (loop/safety/force_limiter.hpp).
  int slew_ticks = 1;
  double power_limit_w = std::numeric_limits<double>::infinity();
  WatchLimits watch;  ///< 0: not watched
};

/// Timing limits that are in force. A simulated device moves nobody: its late ticks and stuck
/// encoders are not watched, and rendering continues after gaps of up to half a second.
[[nodiscard]] WatchLimits watchLimits(const DeviceModel& device, bool simulated);

[[nodiscard]] SupervisorConfig makeSupervisor(const DeviceModel& device, double period_s,
                                              bool simulated);

/// A fault and its axis (-1: no particular axis).
struct Finding {
  Fault faults = Fault::kNone;
  int axis = -1;
};

/// Number of gaps of more than 5 ms that are allowed within one second; one more stops the loop.
inline constexpr int kMostGaps = 3;

/// State of the device watch from tick to tick.
struct DeviceWatchState {
  bool fresh = true;  ///< this is the first tick
  int late_in_a_row = 0;
  std::array<double, kMostGaps> since_gap_s{9.0, 9.0, 9.0};  ///< newest first; 9 s: none yet
  std::array<int, kMaxAxes> fast_ticks{};  ///< consecutive ticks beyond the speed limit
  AxisPosition q;         ///< position at the last tick; before the first tick, at arming
  AxisPosition still_at;  ///< position at which an axis has stood still
  AxisPosition left;      ///< position at which it stood still before
  /// The standstill began with one sample far away and back: what its effort then did is no
  /// evidence of a stuck encoder.
  std::array<bool, kMaxAxes> spiked{};
  std::array<double, kMaxAxes> still_s{};  ///< duration of the standstill
  /// Value of `travelled` when the standstill began.
  std::array<double, kMaxAxes> travelled_before{};
  AxisEffort least, most;  ///< smallest and largest effort sent since the standstill began
  double travelled = 0.0;  ///< sum of all base axes' travel, in fractions of their ranges
};

/// Checks the device's reading, before anything is computed from it:
///   kSpeedLimit    |Δq| > q̇_max kT + 2δ in two consecutive ticks, because a late reading makes
///                  the next one early. In the first tick: the axis is more than a twentieth of its
///                  range away from its position at arming
///   kEncoderJump   |Δq| > 3 q̇_max kT + 2δ: faster than any hand moves. Also instead of
///                  kEncoderStuck if one sample was more than 4 counts away from where the axis
///                  stands before and after it: that sample changed the effort
///   kWorkspace     beyond the range by more than the margin
///   kEncoderStuck  within 1.5 counts for stuck_encoder_s, not at a stop, while the axis's own
///                  effort changed by a fifth of its limit or, on a base axis, the other base axes
///                  travelled five ranges. Fingers may rest while the arm moves, and the arm while
///                  the fingers move: neither is evidence
///   kLateInARow    late ticks in a row, or more than three gaps of over 5 ms in any second
///   kLongGap       a gap longer than the allowed one
///
/// Every fault except those of timing names the first axis that has it. Real-time safe.
/// @param sent the last effort sent
[[nodiscard]] WHOLEHAND_RT Finding watchDevice(DeviceWatchState& state, const AxisPosition& q_m,
                                               const AxisEffort& sent, int elapsed_periods,
                                               const SupervisorConfig& config) noexcept;

/// State of the avatar watch from tick to tick.
struct AvatarWatchState {
  double catch_up_left_s = 0.0;  ///< remaining time in which the hand catches up after a stall
};

/// Returns kBodiesExploded when the simulated hand is ten times as fast as the device may be, which
/// is ten times the speed that contact within the limits can cause. When gaps are only counted, the
/// check pauses for 0.2 s after a gap of more than 5 periods, because the simulated hand then
/// catches up with the device. Real-time safe.
[[nodiscard]] WHOLEHAND_RT Fault watchAvatar(AvatarWatchState& state, const TickRecord& observed,
                                             const SupervisorConfig& config) noexcept;

/// Computes the state after a tick. Real-time safe.
/// @param latched stopping faults of this run so far @param at_neutral the device is at neutral
/// after a stop or a fault
[[nodiscard]] WHOLEHAND_RT SafetyState nextSafetyState(SafetyState state, Fault latched,
                                                       bool at_neutral, double authority) noexcept;

}  // namespace wholehand
