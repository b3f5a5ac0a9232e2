#pragma once

#include <string>
#include <string_view>

namespace wholehand {

/// Escapes text for HTML content and quoted attributes. Control characters, which HTML does not
/// allow, become spaces.
[[nodiscard]] std::string escapeHtml(std::string_view text);

}  // namespace wholehand
