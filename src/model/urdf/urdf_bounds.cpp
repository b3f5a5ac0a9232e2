#include "model/urdf/urdf_bounds.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>

namespace wholehand {
namespace {

// A robot's whole description has some 2,000 attributes; an element has two '<'.
constexpr std::ptrdiff_t kMostAttributes = 8'000, kMostTags = 32'000;
constexpr std::streamsize kLargestFile_bytes = std::streamsize{4} << 20U;

}  // namespace

std::string beyondUrdfBounds(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::array<char, 16384> block;
  std::streamsize bytes = 0;
  std::ptrdiff_t attributes = 0, tags = 0;
  while (in.read(block.data(), block.size()) || in.gcount() > 0) {
    const auto end = block.begin() + in.gcount();
    bytes += in.gcount();
    attributes += std::count(block.begin(), end, '=');
    tags += std::count(block.begin(), end, '<');
    if (bytes > kLargestFile_bytes) return "is larger than 4 MB";
    if (attributes > kMostAttributes) return "has more than 8000 attributes";
    if (tags > kMostTags) return "has more than 16000 elements";
  }
  return {};
}

}  // namespace wholehand
