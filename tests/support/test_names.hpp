#pragma once

#include <string>

namespace wholehand::test {

/// A name without hyphens, as GoogleTest requires.
inline std::string withoutHyphens(std::string name) {
  std::erase(name, '-');
  return name;
}

}  // namespace wholehand::test
