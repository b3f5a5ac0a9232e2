#pragma once

#include <cstddef>
#include <cstdint>

namespace wholehand {

/// CRC-32 of IEEE 802.3 (the one of zip and PNG), eight bytes at a time. Real-time safe and
/// async-signal-safe. Start with 0; to go on, give what came of the bytes before.
[[nodiscard]] std::uint32_t crc32(std::uint32_t crc, const std::byte* bytes,
                                  std::size_t count) noexcept;

}  // namespace wholehand
