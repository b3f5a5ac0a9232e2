#pragma once

#include "core/expected.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// Why a text is no configuration that a person wrote, before it is parsed: too many keys, tables
/// or levels within each other. The parser recurses for each level, and what reads its tables looks
/// through all their keys for each. Nothing where it is within bounds.
[[nodiscard]] std::optional<Diagnostic> beyondBounds(std::string_view toml,
                                                     const std::string& path);

}  // namespace wholehand
