#include "files/patient/csv_line.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace wholehand {
namespace {

/// Bytes of the first UTF-8 character; 0 if it is invalid.
std::size_t characterBytes(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  const std::size_t bytes = lead < 0x80   ? 1
                            : lead < 0xC2 ? 0
                            : lead < 0xE0 ? 2
                            : lead < 0xF0 ? 3
                            : lead < 0xF5 ? 4
                                          : 0;
  if (bytes > text.size()) return 0;
  const bool whole =
      std::all_of(text.begin() + 1, text.begin() + static_cast<long>(bytes ? bytes : 1),
                  [](unsigned char c) { return (c & 0xC0U) == 0x80U; });
  return whole ? bytes : 0;
}

}  // namespace

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<Cell> cells(std::string_view line, char separator) {
  std::vector<Cell> found(1);
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    Cell& cell = found.back();
    if (line[i] == separator && !inside) {
      found.emplace_back();
    } else if (line[i] != '"' || !(inside || trimmed(cell.text).empty())) {
      cell.text += line[i];
    } else if (inside && line.substr(i + 1).starts_with('"')) {
      cell.text += line[i++];
    } else {
      inside = !inside;
      cell.quoted = true;
    }
  }
  for (Cell& cell : found) cell.text = std::string(trimmed(cell.text));
  return found;
}

char separatorOf(std::string_view line) {
  constexpr std::string_view kSeparators = ",;\t";
  std::array<int, kSeparators.size()> count{};
  bool inside = false;
  for (const char c : line) {
    if (c == '"') inside = !inside;
    const std::size_t at = inside ? kSeparators.npos : kSeparators.find(c);
    if (at != kSeparators.npos) ++count[at];
  }
  const auto most = std::max_element(count.begin(), count.end());
  return *most == 0 ? '\0' : kSeparators[static_cast<std::size_t>(most - count.begin())];
}

std::string withPoint(std::string text) {
  const std::size_t comma = text.find(',');
  const bool number = text.find_first_not_of("+-,0123456789eE") == text.npos;
  if (number && comma != text.npos && text.find(',', comma + 1) == text.npos) text[comma] = '.';
  return text;
}

bool holdsControl(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](unsigned char c) {
    return (c < 0x20 && c != '\t' && c != '\r') || c == 0x7F;
  });
}

std::string shown(std::string_view value) {
  constexpr std::size_t kLongest = 40;
  std::string out;
  while (!value.empty() && out.size() < kLongest) {
    const std::size_t bytes = characterBytes(value);
    out += bytes > 0 ? value.substr(0, bytes) : "?";
    value.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  return out;
}

}  // namespace wholehand
