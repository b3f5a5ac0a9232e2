#pragma once

#include "core/expected.hpp"
#include "server/backend.hpp"
#include "telemetry/recording.hpp"

#include <string>

namespace wholehand {

/// The session that every replayed state and its scene belong to.
inline constexpr std::uint32_t kReplayedSession = 1;

/// What clients were told of the models that a recording was made with, from the files in it.
/// Refused where these cannot be read, or are not those that the ticks were rendered with.
[[nodiscard]] Expected<SceneFacts> recordedScene(const RecordingMeta& meta,
                                                 const std::string& recording_path);

/// What a client was shown beside a tick, as far as the record tells.
[[nodiscard]] LoopStatus recordedStatus(const TickRecord& record);

}  // namespace wholehand
