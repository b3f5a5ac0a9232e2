#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// Text helpers for CSV files and the messages about them. Private to patient. Not real-time safe.
namespace wholehand {

/// The text without blanks at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// Comma-separated values of a line, each trimmed.
[[nodiscard]] std::vector<std::string_view> cells(std::string_view line);

/// True if the text has control bytes: the file is not text, or UTF-16.
[[nodiscard]] bool holdsControl(std::string_view text);

/// A value for a message: shortened, and safe for terminals.
[[nodiscard]] std::string shown(std::string_view value);

/// "1 value", "2 values"
[[nodiscard]] std::string counted(std::size_t count, const std::string& what);

}  // namespace wholehand
