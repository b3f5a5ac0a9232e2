#pragma once

#include "core/axis_array.hpp"
#include "core/fault.hpp"
#include "core/real_time.hpp"
#include "core/safety_state.hpp"
#include "core/tick_record.hpp"
#include "model/device_model.hpp"

#include <array>
#include <limits>

namespace wholehand {

/// What the supervisor holds a device to, from its file (docs/safety.md).
struct SupervisorConfig {
  int axes = 0;  ///< 0: nothing is watched
  double period_s = 1e-3;
  AxisPosition lower, upper;  ///< end of travel
  AxisPosition margin;        ///< beyond it by more: kWorkspace
  AxisPosition encoder_step;
  AxisRatio carries;  ///< 1: a base axis, which moves with the arm
  AxisVelocity speed_limit;
  AxisEffort effort_limit;
  AxisEffort most_change;  ///< of an effort within slew_ticks: the slew limit
  int slew_ticks = 1;      ///< periods in a millisecond, one at least (safety/slew_limiter.hpp)
  double power_limit_w = std::numeric_limits<double>::infinity();
  WatchLimits watch;  ///< 0: not watched
};

/// @param simulated lateness and encoders that stand still are not watched
[[nodiscard]] SupervisorConfig makeSupervisor(const DeviceModel& device, double period_s,
                                              bool simulated);

/// What was wrong, and on which axis (-1: none in particular).
struct Finding {
  Fault faults = Fault::kNone;
  int axis = -1;
};

/// Gaps of more than 5 ms that are allowed within one second; one more stops the loop.
inline constexpr int kMostGaps = 3;

/// What the watch of the device remembers from tick to tick.
struct DeviceWatchState {
  bool fresh = true;  ///< nothing is known of the tick before
  int late_in_a_row = 0;
  std::array<double, kMostGaps> since_gap_s{9.0, 9.0, 9.0};  ///< the latest first; 9 s: none yet
  std::array<int, kMaxAxes> fast_ticks{};  ///< beyond the speed limit, one after another
  AxisPosition q;         ///< at the last tick; before the first, when it was armed
  AxisPosition still_at;  ///< where an axis stands still, if it does
  std::array<double, kMaxAxes> still_s{};           ///< for so long
  std::array<double, kMaxAxes> travelled_before{};  ///< `travelled` when that began
  AxisEffort least, most;                           ///< effort sent since then
  double travelled = 0.0;  ///< way of all base axes together, in shares of their ranges
};

/// Judges what was read, before anything is computed from it:
///   kSpeedLimit    |Δq| > q̇_max kT + 2δ, in two ticks one after another: a reading may be late,
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

/// Velocities of the bodies at the last tick.
struct WorldWatchState {
  int body_count = -1;  ///< -1: nothing is known of the tick before
  std::array<Vec3, kMaxBodies> velocity_m_s{}, angular_velocity_rad_s{};
  double catches_up_s = 0.0;  ///< the hand still does, after a stall
};

/// kBodiesExploded where a body's velocity changed by more than 10 m/s or 500 rad/s within one
/// step, or the simulated hand is ten times as fast as the device may be: ten times what the touch
/// of a hand within its limits gives. A body that falls for long is no explosion. Where gaps are
/// only counted, nothing is said for 0.2 s after one of more than 5 periods: the simulated hand
/// flies after the device then. Real-time safe.
[[nodiscard]] WHOLEHAND_RT Fault watchWorld(WorldWatchState& state, const TickRecord& observed,
                                            const SupervisorConfig& config) noexcept;

/// Bodies that are put somewhere before the step: their new velocity is no explosion. Real-time
/// safe.
WHOLEHAND_RT void notePlaced(WorldWatchState& state, const BodyPlacements& placements) noexcept;

/// The state after a tick. Real-time safe.
/// @param latched stopping faults of this run so far @param at_neutral after a stop or a fault
[[nodiscard]] WHOLEHAND_RT SafetyState nextSafetyState(SafetyState state, Fault latched,
                                                       bool at_neutral, double authority) noexcept;

}  // namespace wholehand
