#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

/// Layout of a black box file, documented in docs/recording.md. Private to src/record.
///
/// The file is the Header and then each Part in its order: head, bytes, CRC-32 of both. Part::kEnd
/// completes the file.
namespace wholehand::black_box {

inline constexpr std::array<char, 8> kMagic = {'W', 'H', 'B', 'L', 'K', 'B', 'O', 'X'};
inline constexpr std::uint32_t kFormat = 3;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t format = kFormat;
  std::uint32_t header_bytes = 0;
  std::array<char, 64> program{};  ///< version of the program, zero-padded; at the same place in
                                   ///< every format
  std::uint32_t record_bytes = 0, record_layout = 0;
  std::int32_t signal = 0;         ///< signal that ended the process; 0: none
  std::uint32_t faults = 0;        ///< faults that caused the writing
  std::int32_t fault_axis = -1;    ///< axis of the first fault
  std::uint32_t inputs_whole = 0;  ///< 1: no input since arming is missing
  std::uint64_t fault_tick = 0;    ///< tick of the first fault
  std::int64_t unix_ns = 0;
  std::uint64_t ticks_begun = 0, ticks_done = 0;  ///< calls of tick(); they differ by one within a
                                                  ///< tick
  std::uint64_t first_entry = 0, end_entry = 0;   ///< range of the complete ticks kept, counted
                                                  ///< since arming
  std::uint64_t entry_slots = 0;
  std::uint64_t data_begin = 0,
                data_end = 0;  ///< range of the entries' bytes, counted since arming
  std::uint64_t data_capacity = 0;
  std::uint32_t reserved = 0;
  std::uint32_t crc = 0;  ///< CRC-32 of all fields before it
};
static_assert(std::is_trivially_copyable_v<Header>);
static_assert(sizeof(Header) == offsetof(Header, crc) + sizeof(std::uint32_t), "no padding behind");

/// Position of one complete tick.
struct Entry {
  std::uint64_t begin = 0;  ///< offset counted since arming
  std::uint64_t tick = 0;
  std::uint64_t bytes = 0;
};

/// State of the rings after the last byte was written. It shows which data was overwritten during
/// writing; the reader drops that data.
struct End {
  std::uint64_t entries_begun = 0, data_begun = 0;
};

enum class Part : std::uint32_t { kMeta, kInputs, kEntries, kData, kEnd, kCount };

struct PartHeader {
  std::uint32_t part = 0;
  std::uint32_t reserved = 0;
  std::uint64_t bytes = 0;
};

}  // namespace wholehand::black_box

namespace wholehand {

/// More ticks than the loop can begin while the header is filled in.
inline constexpr std::size_t kSpareEntries = 8;
/// Index of the first entry that a black box file contains, for a ring of `slots` slots with `end`
/// finished entries. Slots that the loop writes next are excluded.
[[nodiscard]] constexpr std::uint64_t firstKept(std::uint64_t end, std::uint64_t slots) noexcept {
  return end - std::min<std::uint64_t>(end, slots - kSpareEntries);
}

}  // namespace wholehand
