#include "station/file_name.hpp"

#include "core/printable.hpp"

namespace wholehand {
namespace {

/// Bytes from 0x80 on are parts of characters; printable() has removed all invalid ones.
bool stays(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

bool beginsCharacter(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
}

}  // namespace

std::string fileNamePart(std::string_view text, std::size_t most_bytes) {
  std::string out;
  for (const char c : printable(text, most_bytes)) {
    if (stays(c)) {
      out += c;
    } else if (!out.empty() && out.back() != '-') {
      out += '-';
    }
  }
  if (out.size() > most_bytes) {
    std::size_t end = most_bytes;
    while (end > 0 && !beginsCharacter(out[end])) --end;
    out.resize(end);
  }
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out;
}

}  // namespace wholehand
