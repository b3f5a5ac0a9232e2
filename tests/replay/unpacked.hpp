#pragma once

#include "support/folder.hpp"
#include "support/python.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace wholehand::test {

/// What packBytes() packed, by Python's own base64 and zlib.
inline std::string unpacked(const std::string& text) {
  const Folder folder;
  const std::string packed = folder.file("packed"), bytes = folder.file("bytes");
  std::ofstream(packed) << text;
  EXPECT_EQ(
      python("import base64, zlib\nopen('" + bytes +
             "', 'wb').write(zlib.decompress(base64.b64decode(open('" + packed + "').read())))"),
      "");
  std::ifstream in(bytes, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace wholehand::test
