#pragma once

#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/python.hpp"

#include <gtest/gtest.h>

#include <string>

namespace wholehand::test {

/// Unpacks the text of packBytes() with Python's own base64 and zlib.
inline std::string unpacked(const std::string& text) {
  const Folder folder;
  const std::string packed = folder.write("packed", text), bytes = folder.file("bytes");
  EXPECT_EQ(
      python("import base64, zlib\nopen('" + bytes +
             "', 'wb').write(zlib.decompress(base64.b64decode(open('" + packed + "').read())))"),
      "");
  return bytesOfFile(bytes);
}

}  // namespace wholehand::test
