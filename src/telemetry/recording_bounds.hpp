#pragma once

#include "core/tick_record.hpp"
#include "telemetry/recording.hpp"

#include <string>

/// What a description and a tick of a file may hold: checked where a file is opened, and at every
/// tick that is read. Private to telemetry.
namespace wholehand::recording {

/// Says why this meta cannot describe a TickRecord (too many axes, joints, bodies ...), or nothing.
[[nodiscard]] std::string unusable(const RecordingMeta& meta);
/// True where every array and count of the tick is as that description says.
[[nodiscard]] bool fits(const TickRecord& record, const RecordingMeta& meta);

}  // namespace wholehand::recording
