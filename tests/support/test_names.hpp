#pragma once

#include <string>

namespace wholehand::test {

/// A name as GoogleTest takes it: without hyphens.
inline std::string withoutHyphens(std::string name) {
  std::erase(name, '-');
  return name;
}

}  // namespace wholehand::test
