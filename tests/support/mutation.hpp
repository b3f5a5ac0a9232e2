#pragma once

#include <algorithm>
#include <cstddef>
#include <random>
#include <string>

namespace wholehand::test {

/// `text` with one to eight faults as they occur in files: flipped bits, critical byte values,
/// parts cut out, doubled or overwritten by others, a missing end.
template <class Random>
std::string mutated(std::string text, Random& random) {
  const auto below = [&random](std::size_t n) { return n == 0 ? std::size_t{0} : random() % n; };
  static constexpr unsigned char kTelling[] = {0,   1,   0x7F, 0x80, 0xFF, '0',
                                               '9', '-', '"',  '[',  '\n'};
  for (std::size_t n = below(2) == 0 ? 1 : 1 + below(8); n > 0 && !text.empty(); --n) {
    const std::size_t at = below(text.size());
    const std::size_t length = std::min(text.size() - at, 1 + below(64));
    switch (below(7)) {
      case 0:
        text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
      case 1:
        text[at] = static_cast<char>(kTelling[below(sizeof kTelling)]);
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), length));
        break;
      case 4:
        text.replace(at, length, text.substr(below(text.size()), length));
        break;
      case 5:
        std::fill_n(text.begin() + static_cast<std::ptrdiff_t>(at), length,
                    static_cast<char>(kTelling[below(sizeof kTelling)]));
        break;
      default:
        if (below(4) == 0) text.resize(at);  // rarely, since it leaves little to read
    }
  }
  return text;
}

}  // namespace wholehand::test
