#pragma once

#include "core/tick_record.hpp"
#include "replay/replay_question.hpp"
#include "telemetry/recording.hpp"

#include <string>

namespace wholehand {

/// The extremes of every channel in each column of a stretch of time, and what happened in it, as
/// docs/protocol.md lays them out. Ticks that cannot be read are left out, and told.
[[nodiscard]] std::string seriesMessage(RecordingReader& recording, const SeriesQuestion& question);

/// The first of the recording's ticks at or after a time.
[[nodiscard]] std::uint64_t firstTickAt(const RecordingReader& recording, double time_s);

}  // namespace wholehand
