#pragma once

#include "core/expected.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// Rejects, before parsing, a text with too many keys, tables or nesting levels: the parser
/// recurses for each level, and each look-up searches all keys of a table. Empty when within
/// bounds.
[[nodiscard]] std::optional<Diagnostic> beyondBounds(std::string_view toml,
                                                     const std::string& path);

}  // namespace wholehand
