#pragma once

#include <concepts>

namespace wholehand {

/// Plural ending of a count's noun: "1 tick", "2 ticks".
[[nodiscard]] constexpr const char* plural(std::integral auto count) {
  return count == 1 ? "" : "s";
}

}  // namespace wholehand
