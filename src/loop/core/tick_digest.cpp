#include "loop/core/tick_digest.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

/// Finalizer of SplitMix64 (Steele, Lea, Flood 2014): changing one input bit changes on average
/// half of the output bits.
std::uint64_t mix(std::uint64_t x) noexcept {
  x = (x ^ x >> 30) * 0xBF58'476D'1CE4'E5B9ULL;
  x = (x ^ x >> 27) * 0x94D0'49BB'1331'11EBULL;
  return x ^ x >> 31;
}

}  // namespace

std::uint64_t digestOf(const TickRecord& record) noexcept {
  std::uint64_t digest = 0;
  const auto add = [&digest](std::uint64_t word) noexcept {
    digest = mix(digest + 0x9E37'79B9'7F4A'7C15ULL + word);
  };
  visitComputed(record, [&add](const char*, const double* numbers, int count) noexcept {
    add(static_cast<std::uint64_t>(count));
    for (int i = 0; i < count; ++i) {
      const double v =
          std::isnan(numbers[i]) ? std::numeric_limits<double>::quiet_NaN() : numbers[i];
      add(std::bit_cast<std::uint64_t>(v));
    }
  });
  return digest;
}

}  // namespace wholehand
