#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "device/host/shared_frame.hpp"
#include "safety/neutral_ramp.hpp"
#include "safety/slew_limiter.hpp"

#include <cstdint>

namespace wholehand {

/// The loop is lost when no new command has come for this long.
inline constexpr std::int64_t kLoopSilence_ns = 20'000'000;
/// From WH_ENABLE to the first command, at the neutral effort.
inline constexpr std::int64_t kFirstCommand_ns = 10'000'000'000;

struct GuardConfig {
  AxisEffort neutral;      ///< in the driver's order [N or N·m]
  AxisEffort limit;        ///< ± of each axis [N or N·m]
  AxisEffort most_change;  ///< of each axis within a millisecond: the slew limit [N or N·m]
  double period_s = 250e-6;
  NeutralRampConfig ramp;
};

/// What the host has in hand of one session.
struct GuardState {
  HostPhase phase = HostPhase::kIdle;
  HostReason reason = HostReason::kNone;
  std::uint64_t session = 0;
  std::uint64_t sequence = 0;  ///< of the last command that counted
  std::int64_t alive_ns = 0;   ///< when the loop was last known to live; when the session began
  AxisEffort wanted;           ///< by the last command that counted, within the limits
  NeutralRampState ramp;       ///< ramp.sent: the effort for the device, in every phase
  SlewWindow given;            ///< what the device was given in the last millisecond
};

/// The device has been enabled: neutral, and a clean slate. Real-time safe.
[[nodiscard]] WHOLEHAND_RT GuardState beginSession(std::uint64_t session, std::int64_t now_ns,
                                                   const GuardConfig& config) noexcept;

/// The device has been disabled.
[[nodiscard]] WHOLEHAND_RT GuardState endSession(const GuardState& state,
                                                 const GuardConfig& config) noexcept;

/// One cycle of the host: which effort goes to the device.
///
/// Rendering: the newest command of this session, clamped to ± limit. A command counts as new where
/// its sequence is higher. Where the host itself stood still for more than ramp.gap_s, the effort
/// is blended in anew from what the device held. When the newest is older than kLoopSilence_ns, or
/// is not finite, or `let_go` is given, the effort that the device holds goes to neutral by
/// advanceRamp() - monotone, in 80 ms - and stays there: latched, until beginSession(). The age of
/// a command is that of its own time stamp, or of the cycle that first saw it where that is older.
/// Whatever comes of it, no effort changes by more than most_change within a millisecond. Pure,
/// real-time safe.
/// @param command the newest one; null: there is none
/// @param let_go why the loop is not to be heard any more; kNone: it is
/// @param elapsed_periods of the host, 1 + skipped
[[nodiscard]] WHOLEHAND_RT GuardState advanceGuard(const GuardState& state,
                                                   const HostCommand* command, HostReason let_go,
                                                   int elapsed_periods, std::int64_t now_ns,
                                                   const GuardConfig& config) noexcept;

}  // namespace wholehand
