#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace wholehand {

/// Copies a text into a field of wh_identity; cuts it if it is too long, and ends it with 0.
template <std::size_t kSize>
void fill(char (&field)[kSize], std::string_view text) {
  const std::size_t length = std::min(text.size(), kSize - 1);
  std::copy_n(text.begin(), length, field);
  field[length] = 0;
}

}  // namespace wholehand
