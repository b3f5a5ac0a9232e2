#pragma once

#include "station/server/wire.hpp"

#include <string>
#include <utility>
#include <vector>

namespace wholehand::golden {

/// Messages made by the program's encoders from fixed facts, with the names of their golden files.
/// Facts of an existing golden file must not change: add another message instead.
[[nodiscard]] std::vector<std::pair<std::string, wire::Bytes>> programMessages();

}  // namespace wholehand::golden
