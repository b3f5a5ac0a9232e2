#include "loop/core/crc32.hpp"

#include <zlib.h>

namespace wholehand {

std::uint32_t crc32(std::uint32_t crc, const std::byte* bytes, std::size_t count) noexcept {
  return static_cast<std::uint32_t>(
      ::crc32_z(crc, reinterpret_cast<const unsigned char*>(bytes), count));
}

}  // namespace wholehand
