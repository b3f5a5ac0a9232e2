#pragma once

#include "core/tick_record.hpp"
#include "telemetry/block_index.hpp"
#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_view.hpp"
#include "telemetry/side_table.hpp"
#include "telemetry/table_reader.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace wholehand::recording {

/// The ticks of an open file: which of them are whole, and what they hold. Private to telemetry.
class RecordedTables {
 public:
  /// @param chunks_at_once that are read around a tick
  RecordedTables(const RecordingMeta& meta, std::uint64_t chunks_at_once, const LeftOut& left_out);

  /// Opens the tables and finds the ticks that are whole. What is wrong, or nothing.
  std::string open(hid_t file, bool being_written);
  [[nodiscard]] std::uint64_t size() const noexcept { return rows_.size(); }
  /// Of the ticks that are whole.
  [[nodiscard]] const RecordingOutline& outline() const noexcept { return outline_; }
  /// False where the last whole tick cannot be read.
  [[nodiscard]] bool endsWhole();
  /// Leaves out the last ticks where they cannot be read: the number of the first of these.
  std::optional<std::uint64_t> leaveOutDamagedEnd();
  /// The i-th whole tick. False past the end, and where the file is damaged there.
  bool read(std::uint64_t i, TickRecord& record);

 private:
  template <class Row>
  std::string openTable(hid_t file, const char* name, TableReader<Row>& table);
  bool findTicks(hid_t file);
  std::vector<BlockRow> readIndex(hid_t file) const;
  std::uint64_t takeBlocks(const std::vector<BlockRow>& blocks);
  bool takeNumbers(const std::vector<BlockRow>& blocks, std::size_t begin, std::size_t end);
  bool findRowsFrom(std::uint64_t first_row);
  bool countMissingFrom(std::uint64_t first_row);
  // Of a row of the file.
  bool loadAround(std::uint64_t row);
  bool load(std::uint64_t row, std::uint64_t rows);
  [[nodiscard]] bool holds(std::uint64_t row) const;
  [[nodiscard]] bool isWhole(std::uint64_t row, const TickRecord& counts) const;

  const RecordingMeta& meta_;
  TableReader<TickRecord> ticks_;
  SideTable<ContactRow> contacts_;
  SideTable<EventRow> events_;
  SideTable<CommandRow> commands_;
  std::vector<std::uint64_t> rows_;  ///< of the file, that hold a whole tick
  RecordingOutline outline_;
  const std::uint64_t block_;  ///< rows of a chunk
  const std::uint64_t chunks_at_once_;
  std::uint64_t unreadable_block_ = UINT64_MAX;  ///< the one that was tried last
};

}  // namespace wholehand::recording
