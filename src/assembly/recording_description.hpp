#pragma once

#include "assembly/rig.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <string>

namespace wholehand {

/// Name of the device passport within a recording.
inline constexpr const char* kRecordedPassport = "passport/passport.toml";

/// Metadata of a recording of this rig.
[[nodiscard]] Expected<RecordingMeta> describeRecording(const Rig& rig, const std::string& title,
                                                        std::uint64_t seed, bool simulated_clock);

}  // namespace wholehand
