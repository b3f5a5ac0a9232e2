#pragma once

#include "telemetry/recording.hpp"

#include <string>

namespace wholehand {

/// "lambda-pride" from the embedded file of that kind ("device", "hand", "scene" ...); empty when
/// there is none.
[[nodiscard]] std::string embeddedName(const RecordingMeta& meta, const std::string& kind);

}  // namespace wholehand
