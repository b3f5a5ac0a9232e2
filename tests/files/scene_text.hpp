#pragma once

#include <string>

namespace wholehand::test {

/// The first 4 lines of a scene file.
inline const std::string kSceneHead =
    "kind = \"scene\"\nversion = 1\nname = \"s\"\ngravity_m_s2 = [0, 0, -9.81]\n";

/// A body with a file, 5 lines.
inline std::string fileBody(const std::string& name, const std::string& shape,
                            const std::string& file, double x_m = 0.0) {
  return "[[bodies]]\nname = \"" + name + "\"\nshape = \"" + shape + "\"\nfile = \"" + file +
         "\"\nposition_m = [" + std::to_string(x_m) + ", 0, 0]\n";
}

}  // namespace wholehand::test
