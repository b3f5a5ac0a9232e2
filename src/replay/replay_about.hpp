#pragma once

#include "server/backend.hpp"
#include "telemetry/recording.hpp"

#include <string>

namespace wholehand {

/// Description of a recording, which a page requests first, as JSON: docs/protocol.md.
/// @param facts of its scene; unknown ones are empty
/// @param no_picture_because reason; empty: there is a picture
/// @pre the recording holds ticks
[[nodiscard]] std::string replayAbout(const ViewedRecording& viewed, const std::string& name,
                                      bool still_written, const SceneFacts& facts,
                                      const std::string& no_picture_because);

}  // namespace wholehand
