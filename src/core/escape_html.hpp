#pragma once

#include <string>
#include <string_view>

namespace wholehand {

/// Makes any text safe inside HTML, in content and in quoted attributes; control
/// characters, which no page may hold, become spaces.
[[nodiscard]] std::string escapeHtml(std::string_view text);

}  // namespace wholehand
