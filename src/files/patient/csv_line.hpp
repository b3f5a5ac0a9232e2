#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// A value between commas.
struct Cell {
  std::string text;  ///< value without its quotes
  bool quoted = false;
};

/// Comma-separated values of a line, each trimmed. Inside double quotes a comma is text and two
/// quotes stand for one (RFC 4180).
[[nodiscard]] std::vector<Cell> cells(std::string_view line);

/// The text without blanks at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// True if the text has control bytes: then the file is binary or UTF-16.
[[nodiscard]] bool holdsControl(std::string_view text);

/// A value for a message: shortened, and safe for terminals.
[[nodiscard]] std::string shown(std::string_view value);

}  // namespace wholehand
