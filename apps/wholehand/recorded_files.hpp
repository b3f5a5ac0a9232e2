#pragma once

#include "assembly/models.hpp"
#include "telemetry/recording.hpp"

#include <string>

namespace wholehand {

/// The models of the files that a recording carries. Faults name the recording and the file inside
/// it.
[[nodiscard]] Expected<Models> recordedModels(const RecordingMeta& meta,
                                              const std::string& recording_path);

}  // namespace wholehand
