#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

// Texts of a CSV file and of the messages about it. Private to patient. Not for the tick.
namespace wholehand {

/// Without blanks at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// The values of a line, divided by commas, each trimmed.
[[nodiscard]] std::vector<std::string_view> cells(std::string_view line);

/// True where there are bytes that no text holds: the file is something else (or UTF-16).
[[nodiscard]] bool holdsControl(std::string_view text);

/// A value for a message: not too long, and nothing in it that a terminal would choke on.
[[nodiscard]] std::string shown(std::string_view value);

/// "1 value", "2 values"
[[nodiscard]] std::string counted(std::size_t count, const std::string& what);

}  // namespace wholehand
