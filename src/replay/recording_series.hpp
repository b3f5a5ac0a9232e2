#pragma once

#include "core/tick_record.hpp"
#include "replay/replay_question.hpp"
#include "telemetry/recording.hpp"

#include <string>

namespace wholehand {

/// Extremes of every channel in each column of a time interval, and its events, in the layout of
/// docs/protocol.md. Unreadable ticks are skipped and reported.
[[nodiscard]] std::string seriesMessage(RecordingReader& recording, const SeriesQuestion& question);

/// Index of the recording's first tick at or after a time.
[[nodiscard]] std::uint64_t firstTickAt(const RecordingReader& recording, double time_s);

}  // namespace wholehand
