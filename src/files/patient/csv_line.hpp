#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// A value between separators.
struct Cell {
  std::string text;  ///< value without its quotes
  bool quoted = false;
};

/// Values of a line between separators, each trimmed. Inside double quotes a separator is text and
/// two quotes stand for one (RFC 4180).
[[nodiscard]] std::vector<Cell> cells(std::string_view line, char separator = ',');

/// What divides a line outside of its quotes: the most frequent of comma, semicolon and tab, or 0.
[[nodiscard]] char separatorOf(std::string_view line);

/// A number with its only comma as a point: "0,5" is "0.5". Other texts stay.
[[nodiscard]] std::string withPoint(std::string text);

/// The text without blanks at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text, std::string_view blanks = " \t\r");

/// True if the text has control bytes: then the file is binary or UTF-16.
[[nodiscard]] bool holdsControl(std::string_view text);

/// A value for a message: shortened, and safe for terminals.
[[nodiscard]] std::string shown(std::string_view value);

}  // namespace wholehand
