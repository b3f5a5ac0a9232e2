#pragma once

#include "loop/core/tick_record.hpp"
#include "record/hdf5_handle.hpp"
#include "record/recording.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// The table that writer and reader share; it states where each number of a tick is stored in the
/// file. Documented in docs/recording.md. Private to src/record.
namespace wholehand::recording {

/// One dataset: a row per tick (or per contact).
struct ColumnShape {
  std::string name;
  hdf5::NumberType type = hdf5::NumberType::kFloat32;
  std::vector<std::uint64_t> shape;  ///< shape of one row; empty for a scalar
  std::vector<std::string> units;    ///< one, or one per element of the last dimension
  std::vector<std::string> labels;   ///< one per element of a row's first dimension
  std::vector<std::string> columns;  ///< names along the last dimension when there are two

  [[nodiscard]] std::size_t rowBytes() const noexcept {
    std::size_t n = hdf5::byteSize(type);
    for (std::uint64_t d : shape) n *= d;
    return n;
  }
};

/// A dataset and the conversion between its rows and a structure.
template <class Row>
struct Column : ColumnShape {
  std::function<void(const Row&, std::byte*)> store;
  std::function<void(const std::byte*, Row&)> load;
};

/// Value of a number of a row that never reached the disk: −1 in the file (before schema 10:
/// 2^64 − 1).
inline constexpr std::uint64_t kNeverWritten = UINT64_MAX;

/// One contact and its row of /ticks.
struct ContactRow {
  std::uint64_t row = 0;
  Contact contact;
};

/// One event of the exercise and its row of /ticks.
struct EventRow {
  std::uint64_t row = 0;
  ExerciseEvent event;
};

/// One command and the row of /ticks of the tick that executed it.
struct CommandRow {
  std::uint64_t row = 0;
  Command command;
};

/// The datasets of /ticks. Datasets without columns (no bodies, no joints) are left out.
[[nodiscard]] std::vector<Column<TickRecord>> tickColumns(const RecordingMeta& meta);
/// The column of digests (loop/core/tick_digest.hpp).
inline constexpr const char* kDigest = "digest";
/// The datasets of /contacts.
[[nodiscard]] std::vector<Column<ContactRow>> contactColumns(const RecordingMeta& meta);
/// The datasets of /events.
[[nodiscard]] std::vector<Column<EventRow>> eventColumns(const RecordingMeta& meta);
/// The datasets of /commands.
[[nodiscard]] std::vector<Column<CommandRow>> commandColumns(const RecordingMeta& meta);

/// Rows per chunk: one second of ticks, so that a write fills one chunk.
[[nodiscard]] std::uint64_t chunkRows(double period_s) noexcept;
inline constexpr std::uint64_t kContactChunkRows = 256;
inline constexpr std::uint64_t kRareChunkRows = 64;  ///< events and commands

}  // namespace wholehand::recording
