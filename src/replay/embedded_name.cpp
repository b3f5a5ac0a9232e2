#include "replay/embedded_name.hpp"

#include <cstddef>
#include <sstream>

namespace wholehand {
namespace {

/// Value of a line `key = "value"` in a TOML text; empty when there is none.
std::string tomlText(const std::string& text, const std::string& key) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t equals = line.find_first_not_of(" \t", key.size());
    if (equals == std::string::npos || line[equals] != '=') continue;
    const std::size_t open = line.find('"', equals);
    const std::size_t close = open == std::string::npos ? open : line.find('"', open + 1);
    if (close != std::string::npos) return line.substr(open + 1, close - open - 1);
  }
  return {};
}

}  // namespace

std::string embeddedName(const RecordingMeta& meta, const std::string& kind) {
  for (const auto& [name, text] : meta.files) {
    if (tomlText(text, "kind") == kind) return tomlText(text, "name");
  }
  return {};
}

}  // namespace wholehand
