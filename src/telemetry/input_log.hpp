#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace wholehand {

/// The faults of a tick that came from outside; all others follow from what was read.
inline constexpr Fault kInputFaults =
    Fault::kDeviceRead | Fault::kDeviceWrite | Fault::kStopRequested | Fault::kEmergencyStop;

/// All that a tick took from outside: with it the tick can be run again.
struct TickInput {
  AxisPosition q_m;
  std::uint32_t elapsed_periods = 1;
  Fault faults = Fault::kNone;  ///< of kInputFaults
  std::int32_t command_count = 0;
  std::array<Command, kMaxCommands> commands{};
};

/// No tick takes more bytes in the log.
inline constexpr std::size_t kMostInputBytes = 2048;

/// What both ends of the log remember: the last position of each axis in encoder counts.
struct InputLogState {
  AxisPosition encoder_step;  ///< [m or rad]; 0: the axis has none
  std::array<std::int64_t, kMaxAxes> counts{};
};

/// Writes what a tick took, exactly, in few bytes: one where nothing moved, else one more for each
/// axis; eight for an axis that is at no whole number of counts. Returns the bytes written.
/// Real-time safe.
/// @pre q_m has the axes of state.encoder_step; out has room for kMostInputBytes
WHOLEHAND_RT std::size_t logInput(InputLogState& state, const TickRecord& record,
                                  std::byte* out) noexcept;

/// Reads one tick back; the bytes it took, 0 where they are damaged.
[[nodiscard]] std::size_t readInput(InputLogState& state, const std::byte* in, std::size_t bytes,
                                    TickInput& input);

}  // namespace wholehand
