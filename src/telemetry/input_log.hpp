#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "telemetry/recording.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace wholehand {

/// Faults of a tick that come from outside; all others follow from the inputs.
inline constexpr Fault kInputFaults = kOfReading | Fault::kDeviceWrite | Fault::kStopRequested |
                                      Fault::kEmergencyStop | Fault::kGentleStop;

/// All inputs of a tick: with them it can be run again.
struct TickInput {
  AxisPosition q_m;
  std::uint32_t elapsed_periods = 1;
  Fault faults = Fault::kNone;  ///< subset of kInputFaults
  Mover moved_by = Mover::kNobody;
  Help help = Help::kUnsaid;
  std::int32_t command_count = 0;
  std::array<Command, kMaxCommands> commands{};
};

/// Largest entry of a tick in the log [bytes].
inline constexpr std::size_t kMostInputBytes = 3072;

/// State of both ends of the log: last position of each axis in encoder counts, and who moved.
struct InputLogState {
  AxisPosition encoder_step;  ///< [m or rad]; 0: the axis has none
  std::array<std::int64_t, kMaxAxes> counts{};
  Mover moved_by = Mover::kNobody;
  Help help = Help::kUnsaid;
};
/// State at the beginning of a recording's log.
[[nodiscard]] InputLogState inputLogOf(const RecordingMeta& meta);

/// Writes a tick's inputs losslessly and returns the bytes written: one byte if nothing moved, else
/// one more for each axis; eight for an axis that is not at a whole count. Real-time safe.
/// @pre q_m has the axes of state.encoder_step; out has room for kMostInputBytes
WHOLEHAND_RT std::size_t logInput(InputLogState& state, const TickRecord& record,
                                  std::byte* out) noexcept;

/// Reads a tick. Returns its bytes, 0 when damaged.
[[nodiscard]] std::size_t readInput(InputLogState& state, const std::byte* in, std::size_t bytes,
                                    TickInput& input);

}  // namespace wholehand
