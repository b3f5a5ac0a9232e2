#pragma once

#include "telemetry/recording.hpp"

#include <string>

namespace wholehand {

/// Name stated in the embedded file of a kind ("device", "hand", "scene" ...), e.g. "lambda-pride";
/// empty when there is none.
[[nodiscard]] std::string embeddedName(const RecordingMeta& meta, const std::string& kind);

}  // namespace wholehand
