#pragma once

#include "loop/core/tick_record.hpp"
#include "record/recording.hpp"
#include "record/table_reader.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace wholehand::recording {

/// Last known state of the writer of a file.
enum class WriterState : std::uint8_t {
  kClosed,
  kLeft,  ///< the writer was killed: some datasets may be slightly longer than others
  kWriting
};

/// Finds and reads the complete ticks of an open file. Private to src/record.
class RecordedTables {
 public:
  RecordedTables(const RecordingMeta& meta, const LeftOut& left_out);

  /// Opens the tables and finds the complete ticks. Returns the error, or an empty text.
  std::string open(TablesSource& file, WriterState writer);
  [[nodiscard]] std::uint64_t size() const noexcept { return rows_.size(); }
  /// Outline of the complete ticks.
  [[nodiscard]] const RecordingOutline& outline() const noexcept { return outline_; }
  /// False when the last complete tick cannot be read.
  [[nodiscard]] bool endsWhole();
  /// Drops unreadable ticks at the end; returns the tick number of the first one.
  std::optional<std::uint64_t> leaveOutDamagedEnd();
  /// Reads the i-th complete tick. Returns false past the end and if the file is damaged there.
  bool read(std::uint64_t i, TickRecord& record);
  /// Digest of the tick that was read last; 0 if the column is left out.
  [[nodiscard]] std::uint64_t digest() const noexcept { return digest_; }

 private:
  template <class Row>
  std::string openTable(TablesSource& file, const char* name, TableReader<Row>& table);
  void findRows();
  void countMissing();
  // The functions below take a row of the file.
  bool loadAround(std::uint64_t row);
  [[nodiscard]] bool holds(std::uint64_t row) const;
  [[nodiscard]] bool isWhole(std::uint64_t row, const TickRecord& counts) const;
  [[nodiscard]] std::string contradiction(std::uint64_t row, const TickRecord& counts) const;

  const RecordingMeta& meta_;
  TableReader<TickRecord> ticks_;
  SideTable<ContactRow> contacts_;
  SideTable<EventRow> events_;
  SideTable<CommandRow> commands_;
  std::vector<std::uint64_t> rows_;  ///< file rows that hold a complete tick
  RecordingOutline outline_;
  std::uint64_t digest_ = 0;
  const std::uint64_t block_;                    ///< rows per chunk
  std::uint64_t unreadable_block_ = UINT64_MAX;  ///< block whose reading failed last
};

}  // namespace wholehand::recording
