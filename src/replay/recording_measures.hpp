#pragma once

#include "loop/core/expected.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace wholehand {

/// Version of the measures; counts every change of what one of them means.
inline constexpr int kMeasuresVersion = 2;

/// What a recording says of the person, for records over many visits (docs/clinic.md): results of
/// the exercise's panel, active time, time, speed and path of reaches, how it ended. All of what
/// the person moved (replay/therapy_facts.hpp); helped time is a share of that. Values that the
/// recording does not hold are null. Reads the whole file. One whose writer was killed
/// in its first second has no ticks, and still says whose it is.
[[nodiscard]] Expected<nlohmann::json> recordingMeasures(const std::string& recording_path);

}  // namespace wholehand
