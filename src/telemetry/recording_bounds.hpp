#pragma once

#include "core/tick_record.hpp"
#include "telemetry/recording.hpp"

#include <string>

/// Limits of a file's description and ticks: checked when it is opened, and for every tick read.
/// Private to telemetry.
namespace wholehand::recording {

/// Reason why this meta cannot describe a TickRecord (too many axes, joints, bodies ...), or an
/// empty text.
[[nodiscard]] std::string unusable(const RecordingMeta& meta);
/// False when a number that every reader computes with cannot have been written by a tick: a time
/// that is not finite, an impossible count.
[[nodiscard]] bool isPlausible(const TickRecord& record);
/// True when isPlausible(), and every array and count of the tick matches the description.
[[nodiscard]] bool fits(const TickRecord& record, const RecordingMeta& meta);

}  // namespace wholehand::recording
