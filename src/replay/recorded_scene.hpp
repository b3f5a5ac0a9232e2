#pragma once

#include "core/expected.hpp"
#include "server/backend.hpp"
#include "telemetry/recording.hpp"

#include <string>

namespace wholehand {

/// Session number of all replayed states and their scene.
inline constexpr std::uint32_t kReplayedSession = 1;

/// Scene facts of a recording, rebuilt from the model files that it carries. Refused when these
/// cannot be read, or differ from the models that were rendered.
[[nodiscard]] Expected<SceneFacts> recordedScene(const RecordingMeta& meta,
                                                 const std::string& recording_path);

/// Loop status of a tick, as far as the record tells.
[[nodiscard]] LoopStatus recordedStatus(const TickRecord& record);

}  // namespace wholehand
