#pragma once

#include "assembly/rig.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <string>

namespace wholehand {

/// Under which name a recording carries the passport of the device that it was made with.
inline constexpr const char* kRecordedPassport = "passport/passport.toml";

/// What a recording of this rig says of itself.
[[nodiscard]] Expected<RecordingMeta> describeRecording(const Rig& rig, const std::string& title,
                                                        std::uint64_t seed, bool simulated_clock);

}  // namespace wholehand
