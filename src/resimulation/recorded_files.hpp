#pragma once

#include "assembly/models.hpp"
#include "telemetry/recording.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Models from the files that a recording carries. Faults name the recording and the file inside
/// it.
[[nodiscard]] Expected<Models> recordedModels(const RecordingMeta& meta,
                                              const std::string& recording_path);

/// Device models at the worst corners of the recording's passport (commissioning/passport.hpp);
/// none without a passport.
[[nodiscard]] Expected<std::vector<DeviceModel>> recordedCorners(const RecordingMeta& meta,
                                                                 const DeviceModel& device,
                                                                 const std::string& recording_path);

}  // namespace wholehand
