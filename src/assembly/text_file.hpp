#pragma once

#include "core/expected.hpp"

#include <string>

namespace wholehand {

/// Writes a file through a temporary one beside it; nothing half-written.
[[nodiscard]] Expected<Done> writeText(const std::string& path, const std::string& text);

/// Fails where `path` could not be written later: checked before a run, not after it.
[[nodiscard]] Expected<Done> checkWritable(const std::string& path);

}  // namespace wholehand
