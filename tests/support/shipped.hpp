#pragma once

#include <algorithm>
#include <cstdint>
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

/// The right or the left hand of every size, by the seed, since mirror images have all else in
/// common; both if `all`.
inline std::vector<std::string> shippedHands(std::uint64_t seed, bool all) {
  std::vector<std::string> hands = shipped("hands");
  if (all) return hands;
  std::erase_if(hands, [seed](const std::string& name) {
    const bool right = name.ends_with("-right");
    const std::string size = name.substr(0, name.rfind('-'));
    return right != ((seed + size.back() + size.size()) % 2 == 0);
  });
  return hands;
}

}  // namespace wholehand::test
