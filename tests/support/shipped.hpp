#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace wholehand::test {

/// Names of the shipped files of a kind ("devices", "hands", "scenes" ..), without .toml, sorted.
inline std::vector<std::string> shipped(const std::string& kind) {
  std::vector<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(WHOLEHAND_SOURCE_DIR) + "/config/" + kind)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace wholehand::test
