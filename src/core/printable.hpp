#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wholehand {

/// Fit for a terminal, a log or a list: control characters (C0, DEL, C1), marks that turn the
/// direction of writing, and bytes that are no UTF-8 are shown as \xNN or \u{NNNN}; cut, with
/// "...", after `longest` characters. Not for the tick.
[[nodiscard]] std::string printable(std::string_view text, std::size_t longest = 200);
/// True where printable() shows the text as it stands.
[[nodiscard]] bool isPrintable(std::string_view text, std::size_t longest = 200);

}  // namespace wholehand
