#pragma once

#include <cstddef>
#include <cstdint>

namespace wholehand {

/// CRC-32 (IEEE 802.3), computed by zlib. Real-time safe and async-signal-safe: zlib only reads
/// constant tables.
/// @param crc 0 to start, or the result for the preceding bytes  @param bytes not null
[[nodiscard]] std::uint32_t crc32(std::uint32_t crc, const std::byte* bytes,
                                  std::size_t count) noexcept;

}  // namespace wholehand
