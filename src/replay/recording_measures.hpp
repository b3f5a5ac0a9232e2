#pragma once

#include "loop/core/expected.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace wholehand {

/// Version of the measures; increases with every change of meaning.
inline constexpr int kMeasuresVersion = 3;

/// Measures of a recording for records over many visits (docs/clinic.md): results of the exercise's
/// panel, the threshold of an exercise that compares (comparedJson()), times active, helped and led
/// (ActiveTime), time, speed and path of reaches, and how the session ended (endedBy()). They count
/// only what the person moved (replay/therapy_facts.hpp). Values that the recording does not hold
/// are null. Reads the whole file. A recording whose writer was killed in its first second has no
/// ticks, but its measures still name the visit.
[[nodiscard]] Expected<nlohmann::json> recordingMeasures(const std::string& recording_path);

}  // namespace wholehand
