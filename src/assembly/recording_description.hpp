#pragma once

#include "assembly/rig.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <string>

namespace wholehand {

/// What a recording of this rig says of itself.
[[nodiscard]] Expected<RecordingMeta> describeRecording(const Rig& rig, const std::string& title,
                                                        std::uint64_t seed, bool simulated_clock);

}  // namespace wholehand
