#pragma once

#include "core/tick_record.hpp"
#include "telemetry/block_index.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_view.hpp"
#include "telemetry/side_table.hpp"
#include "telemetry/table_reader.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace wholehand::recording {

/// The ticks of an open file: finds the complete ones and reads them. Private to telemetry.
class RecordedTables {
 public:
  /// @param chunks_at_once number of chunks read around a tick
  RecordedTables(const RecordingMeta& meta, std::uint64_t chunks_at_once, const LeftOut& left_out);

  /// Opens the tables and finds the complete ticks. Returns the error, or an empty text.
  std::string open(TablesSource& file, bool being_written);
  [[nodiscard]] std::uint64_t size() const noexcept { return rows_.size(); }
  /// Outline of the complete ticks.
  [[nodiscard]] const RecordingOutline& outline() const noexcept { return outline_; }
  /// False when the last complete tick cannot be read.
  [[nodiscard]] bool endsWhole();
  /// Drops unreadable ticks at the end; returns the number of the first of them.
  std::optional<std::uint64_t> leaveOutDamagedEnd();
  /// Reads the i-th complete tick. False past the end, and where the file is damaged.
  bool read(std::uint64_t i, TickRecord& record);

 private:
  template <class Row>
  std::string openTable(TablesSource& file, const char* name, TableReader<Row>& table);
  bool findTicks(TablesSource& file);
  std::vector<BlockRow> readIndex(TablesSource& file) const;
  std::uint64_t takeBlocks(const std::vector<BlockRow>& blocks);
  bool takeNumbers(const std::vector<BlockRow>& blocks, std::size_t begin, std::size_t end);
  bool findRowsFrom(std::uint64_t first_row);
  bool countMissingFrom(std::uint64_t first_row);
  // The functions below take a row of the file.
  bool loadAround(std::uint64_t row);
  bool load(std::uint64_t row, std::uint64_t rows);
  [[nodiscard]] bool holds(std::uint64_t row) const;
  [[nodiscard]] bool isWhole(std::uint64_t row, const TickRecord& counts) const;

  const RecordingMeta& meta_;
  TableReader<TickRecord> ticks_;
  SideTable<ContactRow> contacts_;
  SideTable<EventRow> events_;
  SideTable<CommandRow> commands_;
  std::vector<std::uint64_t> rows_;  ///< file rows that hold a complete tick
  RecordingOutline outline_;
  const std::uint64_t block_;  ///< rows per chunk
  const std::uint64_t chunks_at_once_;
  std::uint64_t unreadable_block_ = UINT64_MAX;  ///< block whose reading failed last
};

}  // namespace wholehand::recording
