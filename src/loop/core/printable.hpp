#pragma once

#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>

namespace wholehand {

/// Makes text safe for a terminal, a log or a list. Control characters (C0, DEL, C1), bidirectional
/// marks, line separators and bytes that are not UTF-8 are shown as \xNN or \u{NNNN}. Text longer
/// than `longest` characters is cut and ends with "...". Not real-time safe.
[[nodiscard]] std::string printable(std::string_view text, std::size_t longest = 200);
/// True when printable() leaves the text unchanged.
[[nodiscard]] bool isPrintable(std::string_view text, std::size_t longest = 200);

/// Escapes text for HTML content and quoted attributes. Control characters, which HTML does not
/// allow, become spaces.
[[nodiscard]] std::string escapeHtml(std::string_view text);

/// Plural ending of a count's noun: "1 tick", "2 ticks".
[[nodiscard]] constexpr const char* plural(std::integral auto count) {
  return count == 1 ? "" : "s";
}

}  // namespace wholehand
