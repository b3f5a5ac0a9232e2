#pragma once

#include "telemetry/recording.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

/// How a black box lies in its file; docs/recording.md tells people. Private to telemetry.
///
/// Header, then each Part in its order: head, bytes, CRC-32 of both. The
/// last one closes the file.
namespace wholehand::black_box {

inline constexpr std::array<char, 8> kMagic = {'W', 'H', 'B', 'L', 'K', 'B', 'O', 'X'};
inline constexpr std::uint32_t kFormat = 1;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t format = kFormat;
  std::uint32_t header_bytes = 0;
  std::array<char, 64> program{};  ///< its version, filled up with zeros; every format has it here
  std::uint32_t record_bytes = 0, record_layout = 0;
  std::int32_t signal = 0;         ///< that ended the process; 0: none
  std::uint32_t faults = 0;        ///< that called for the box
  std::int32_t fault_axis = -1;    ///< of the first of them
  std::uint32_t inputs_whole = 0;  ///< 1: none is missing since arming
  std::uint64_t fault_tick = 0;    ///< of the first of them
  std::int64_t unix_ns = 0;
  std::uint64_t ticks_begun = 0, ticks_done = 0;  ///< calls; one apart: within a tick
  std::uint64_t first_entry = 0, end_entry = 0;   ///< of the ticks kept whole, counted since arming
  std::uint64_t entry_slots = 0;
  std::uint64_t data_begin = 0, data_end = 0;  ///< of their bytes, counted since arming
  std::uint64_t data_capacity = 0;
  std::uint32_t reserved = 0;
  std::uint32_t crc = 0;  ///< of all before it
};
static_assert(std::is_trivially_copyable_v<Header>);
static_assert(sizeof(Header) == offsetof(Header, crc) + sizeof(std::uint32_t), "no padding behind");

/// Where one tick kept whole lies.
struct Entry {
  std::uint64_t begin = 0;  ///< counted since arming
  std::uint64_t tick = 0;
  std::uint64_t bytes = 0;
};

/// What had begun when the last byte had been written: what was overwritten meanwhile is dropped.
struct End {
  std::uint64_t entries_begun = 0, data_begun = 0;
};

enum class Part : std::uint32_t { kMeta, kInputs, kEntries, kData, kEnd, kCount };

struct PartHeader {
  std::uint32_t part = 0;
  std::uint32_t reserved = 0;
  std::uint64_t bytes = 0;
};

/// A recording's meta and the encoder steps as bytes, and back. False where they are damaged.
[[nodiscard]] std::vector<std::byte> packMeta(RecordingMeta meta, std::vector<double> encoder_step);
[[nodiscard]] bool unpackMeta(const std::byte* in, std::size_t bytes, RecordingMeta& meta,
                              std::vector<double>& encoder_step);

}  // namespace wholehand::black_box
