#pragma once

#include "core/tick_record.hpp"
#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// Which numbers of a tick stand where in the file: the one table that writer and reader share.
/// Told to people in docs/recording.md. Private to telemetry.
namespace wholehand::recording {

/// One dataset: a row per tick (or per contact).
struct ColumnShape {
  std::string name;
  hdf5::NumberType type = hdf5::NumberType::kFloat64;
  std::vector<std::uint64_t> shape;  ///< of one row; empty for a plain number
  std::vector<std::string> units;    ///< one, or one for each element of the last dimension
  std::vector<std::string> labels;   ///< one for each element of the first dimension of a row
  std::vector<std::string> columns;  ///< names along the last dimension where there are two
  bool packed = false;               ///< the file holds how far each number is from its prediction

  /// Of the numbers in the file.
  [[nodiscard]] hdf5::NumberType fileType() const noexcept {
    return packed ? hdf5::NumberType::kUint64 : type;
  }
  [[nodiscard]] std::size_t rowBytes() const noexcept {
    std::size_t n = hdf5::byteSize(type);
    for (std::uint64_t d : shape) n *= d;
    return n;
  }
};

/// A dataset and how its row is taken from, and put back into, a structure.
template <class Row>
struct Column : ColumnShape {
  std::function<void(const Row&, std::byte*)> store;
  std::function<void(const std::byte*, Row&)> load;
};

/// One contact and the row of /ticks it belongs to.
struct ContactRow {
  std::uint64_t row = 0;
  Contact contact;
};

/// One event of the exercise and the row of /ticks it belongs to.
struct EventRow {
  std::uint64_t row = 0;
  ExerciseEvent event;
};

/// One command and the row of /ticks that took it.
struct CommandRow {
  std::uint64_t row = 0;
  Command command;
};

/// The datasets of /ticks in a file of meta.schema. Datasets that would have no columns (no bodies,
/// no joints) are left out.
[[nodiscard]] std::vector<Column<TickRecord>> tickColumns(const RecordingMeta& meta);
/// The datasets of /contacts.
[[nodiscard]] std::vector<Column<ContactRow>> contactColumns();
/// The datasets of /events.
[[nodiscard]] std::vector<Column<EventRow>> eventColumns();
/// The datasets of /commands.
[[nodiscard]] std::vector<Column<CommandRow>> commandColumns(const RecordingMeta& meta);

/// What of these columns the file tells.
template <class Row>
[[nodiscard]] std::vector<ColumnShape> shapesOf(const std::vector<Column<Row>>& columns) {
  return {columns.begin(), columns.end()};
}

/// The rows that one chunk holds: about a quarter of a second, so that a write fills one chunk.
[[nodiscard]] std::uint64_t chunkRows(double period_s) noexcept;
inline constexpr std::uint64_t kContactChunkRows = 512;
inline constexpr std::uint64_t kRareChunkRows = 64;  ///< events and commands

}  // namespace wholehand::recording
