#pragma once

#include "server/backend.hpp"
#include "telemetry/recording_view.hpp"

#include <string>

namespace wholehand {

/// What a page is told of a recording first, as JSON: docs/protocol.md.
/// @param facts of its scene; those that are not known are empty
/// @param no_picture_because empty: there is a picture
/// @pre it holds ticks
[[nodiscard]] std::string replayAbout(const ViewedRecording& viewed, const std::string& name,
                                      bool still_written, const SceneFacts& facts,
                                      const std::string& no_picture_because);

}  // namespace wholehand
