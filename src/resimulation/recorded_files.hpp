#pragma once

#include "assembly/models.hpp"
#include "telemetry/recording.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// The models of the files that a recording carries. Faults name the recording and the file inside
/// it.
[[nodiscard]] Expected<Models> recordedModels(const RecordingMeta& meta,
                                              const std::string& recording_path);

/// The device at the worst corners of the passport that a recording carries
/// (commissioning/passport.hpp); none where it carries none.
[[nodiscard]] Expected<std::vector<DeviceModel>> recordedCorners(const RecordingMeta& meta,
                                                                 const DeviceModel& device,
                                                                 const std::string& recording_path);

}  // namespace wholehand
