#pragma once

#include "station/server/wire.hpp"

#include <string>
#include <utility>
#include <vector>

namespace wholehand::golden {

/// Messages that the program's encoders make of fixed facts, with the names of their golden files.
/// Facts that a golden file was made of must not change: add another message instead.
[[nodiscard]] std::vector<std::pair<std::string, wire::Bytes>> programMessages();

}  // namespace wholehand::golden
