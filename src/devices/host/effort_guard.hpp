#pragma once

#include "devices/host/host_segment.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/safety/force_limiter.hpp"
#include "loop/safety/neutral_ramp.hpp"

#include <cstdint>

namespace wholehand {

/// Timeout of the loop's commands.
inline constexpr std::int64_t kLoopSilence_ns = 20'000'000;
/// Timeout from WH_ENABLE to the first command, at the neutral effort.
inline constexpr std::int64_t kFirstCommand_ns = 10'000'000'000;

struct GuardConfig {
  AxisEffort neutral;      ///< neutral efforts in the driver's order [N or N·m]
  AxisEffort limit;        ///< limit ± of each axis [N or N·m]
  AxisEffort most_change;  ///< slew limit: largest change in a millisecond [N or N·m]
  double period_s = 250e-6;
  NeutralRampConfig ramp;
  /// A drive that gives no new sample for longer says nothing new (longestStill_s()).
  std::int64_t longest_still_ns = 20'000'000;
};

/// The command with which the device is enabled.
[[nodiscard]] wh_command neutralOf(const GuardConfig& config) noexcept;

/// State of the guard in one session.
struct GuardState {
  HostPhase phase = HostPhase::kIdle;
  ReleaseReason reason = ReleaseReason::kNone;
  std::uint64_t session = 0;
  std::uint64_t sequence = 0;        ///< sequence number of the last accepted command
  std::int64_t last_command_ns = 0;  ///< time at which the loop was last alive, or the session
                                     ///< began
  AxisEffort wanted;                 ///< effort of the last accepted command, within the limits
  NeutralRampState ramp;             ///< ramp.sent: effort sent to the device, in every phase
  SlewWindow given;                  ///< efforts sent in the last millisecond
};

/// State after the device was enabled: at neutral, without history. Real-time safe.
[[nodiscard]] WHOLEHAND_RT GuardState beginSession(std::uint64_t session, std::int64_t now_ns,
                                                   const GuardConfig& config) noexcept;

/// State after the device was disabled.
[[nodiscard]] WHOLEHAND_RT GuardState endSession(const GuardState& state,
                                                 const GuardConfig& config) noexcept;

/// Computes the efforts for the device, once per cycle of the host.
///
/// While rendering, it is the newest command of this session, clamped to ± limit. A command is new
/// when its sequence number is higher. After a stall of the host longer than ramp.gap_s, the effort
/// is blended in again from the one that the device held. When the newest command is older than
/// kLoopSilence_ns or not finite, or `let_go` is given, the present effort goes to neutral by
/// advanceRamp(), monotonically within 80 ms. It then stays latched at neutral until
/// beginSession(). The age of a command counts from its own time stamp, or from the cycle that
/// first saw it if that is earlier. No effort ever changes by more than most_change within a
/// millisecond. Pure, real-time safe.
/// @param command the newest command; null: none
/// @param let_go why the loop must be ignored from now on; kNone: it is not ignored
/// @param elapsed_periods 1 + skipped periods of the host
[[nodiscard]] WHOLEHAND_RT GuardState advanceGuard(const GuardState& state,
                                                   const HostCommand* command, ReleaseReason let_go,
                                                   int elapsed_periods, std::int64_t now_ns,
                                                   const GuardConfig& config) noexcept;

}  // namespace wholehand
