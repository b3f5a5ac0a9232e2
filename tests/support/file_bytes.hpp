#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace wholehand::test {

inline std::string bytesOfFile(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The text with the first `find` replaced, which must be there.
inline std::string replaced(std::string text, const std::string& find, const std::string& with) {
  const std::size_t at = text.find(find);
  EXPECT_NE(at, std::string::npos) << "there is no: " << find;
  if (at != std::string::npos) text.replace(at, find.size(), with);
  return text;
}

inline void writeBytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace wholehand::test
