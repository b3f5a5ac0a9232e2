#include "core/crc32.hpp"

#include <array>

namespace wholehand {
namespace {

constexpr std::uint32_t kPolynomial = 0xEDB88320U;
using Table = std::array<std::array<std::uint32_t, 256>, 8>;

// t[j][b]: what byte b does to the remainder j bytes later.
constexpr Table makeTable() {
  Table t{};
  for (std::uint32_t b = 0; b < 256; ++b) {
    std::uint32_t r = b;
    for (int bit = 0; bit < 8; ++bit) r = r >> 1U ^ ((r & 1U) != 0 ? kPolynomial : 0U);
    t[0][b] = r;
  }
  for (std::size_t j = 1; j < t.size(); ++j) {
    for (std::size_t b = 0; b < 256; ++b) t[j][b] = t[j - 1][b] >> 8U ^ t[0][t[j - 1][b] & 0xFFU];
  }
  return t;
}

constexpr Table kTable = makeTable();

std::uint32_t at(const std::byte* bytes, std::size_t i) noexcept {
  return std::to_integer<std::uint32_t>(bytes[i]);
}

}  // namespace

std::uint32_t crc32(std::uint32_t crc, const std::byte* bytes, std::size_t count) noexcept {
  std::uint32_t r = ~crc;
  for (; count >= 8; count -= 8, bytes += 8) {
    r ^= at(bytes, 0) | at(bytes, 1) << 8U | at(bytes, 2) << 16U | at(bytes, 3) << 24U;
    r = kTable[7][r & 0xFFU] ^ kTable[6][r >> 8U & 0xFFU] ^ kTable[5][r >> 16U & 0xFFU] ^
        kTable[4][r >> 24U] ^ kTable[3][at(bytes, 4)] ^ kTable[2][at(bytes, 5)] ^
        kTable[1][at(bytes, 6)] ^ kTable[0][at(bytes, 7)];
  }
  for (; count > 0; --count, ++bytes) r = r >> 8U ^ kTable[0][(r ^ at(bytes, 0)) & 0xFFU];
  return ~r;
}

}  // namespace wholehand
