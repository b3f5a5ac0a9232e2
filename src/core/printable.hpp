#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wholehand {

/// Text for a terminal, a log or a list. Control characters (C0, DEL, C1), bidirectional marks,
/// line separators and bytes that are not UTF-8 are shown as \xNN or \u{NNNN}. Cut with "..." after
/// `longest` characters. Not real-time safe.
[[nodiscard]] std::string printable(std::string_view text, std::size_t longest = 200);
/// True when printable() leaves the text unchanged.
[[nodiscard]] bool isPrintable(std::string_view text, std::size_t longest = 200);

}  // namespace wholehand
