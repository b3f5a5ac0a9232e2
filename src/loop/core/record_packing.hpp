#pragma once

#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"

#include <cstddef>
#include <cstdint>

namespace wholehand {

/// Size limit of a packed record [bytes].
inline constexpr std::size_t kMostPackedBytes = sizeof(TickRecord);

/// Packs the used part of a record (its axes, bodies, contacts, commands) without gaps; returns its
/// size. Only the same program on the same machine can read the result: it serves the black box
/// file and the queue of records. Real-time safe, async-signal-safe.
/// @pre out has room for kMostPackedBytes
WHOLEHAND_RT std::size_t packRecord(const TickRecord& record, std::byte* out) noexcept;

/// Unpacks a record; unused parts are zero. False when the bytes are invalid.
[[nodiscard]] bool unpackRecord(const std::byte* packed, std::size_t bytes, TickRecord& record);

/// Hash of the record's layout: two programs with the same hash can read each other's packed
/// records.
[[nodiscard]] std::uint32_t recordLayout() noexcept;

/// Size of a packed record with these numbers of axes, joints, bodies, values and contacts.
[[nodiscard]] std::size_t packedBytes(int axes, int joints, int bodies, int values, int contacts);

}  // namespace wholehand
