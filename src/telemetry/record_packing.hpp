#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"

#include <cstddef>
#include <cstdint>

namespace wholehand {

/// No packed record is larger.
inline constexpr std::size_t kMostPackedBytes = sizeof(TickRecord);

/// Lays what a record uses (its axes, bodies, contacts, commands) end to end; the bytes it takes.
/// For the same program on the same machine: the black box. Real-time safe, async-signal-safe.
/// @pre out has room for kMostPackedBytes
WHOLEHAND_RT std::size_t packRecord(const TickRecord& record, std::byte* out) noexcept;

/// The record that was packed, zero where nothing was used. False where the bytes are none.
[[nodiscard]] bool unpackRecord(const std::byte* packed, std::size_t bytes, TickRecord& record);

/// Changes whenever the layout of a record does.
[[nodiscard]] std::uint32_t recordLayout() noexcept;

/// The bytes of a packed record with so many axes, joints, bodies, values and contacts.
[[nodiscard]] std::size_t packedBytes(int axes, int joints, int bodies, int values,
                                      int contacts) noexcept;

}  // namespace wholehand
