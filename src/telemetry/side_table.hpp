#pragma once

#include "telemetry/recording_layout.hpp"
#include "telemetry/table_reader.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace wholehand::recording {

/// A table with any number of rows per tick: its reader, and the assignment of rows to ticks.
template <class Row>
class SideTable {
 public:
  explicit SideTable(std::vector<Column<Row>> columns) : table(std::move(columns)) {}

  /// Finds the rows of every block of /ticks, which has so many rows. Until the next load(), their
  /// assignment to ticks is known. Rows that cannot be read belong to no tick.
  void findBlocks(std::uint64_t ticks, std::uint64_t block_rows) {
    std::vector<std::uint64_t> owners;
    table.readSound("row", kContactChunkRows, UINT64_MAX, owners);
    assign(owners, 0, 0, ticks);
    for (std::uint64_t tick = 0; tick < ticks; tick += block_rows) {
      blocks_.push_back(rowsOf(tick, std::min(ticks, tick + block_rows)));
    }
  }
  /// True when all rows of that tick are present. @pre it was found or loaded
  [[nodiscard]] bool isWhole(std::uint64_t tick, std::int32_t count, int most) const {
    return countOf(tick) == static_cast<std::uint64_t>(std::clamp(count, 0, most));
  }
  /// Loads the rows of these ticks; `tick` is the first of a block.
  bool load(std::uint64_t tick, std::uint64_t end_tick, std::uint64_t block_rows) {
    of_tick_.clear();
    std::uint64_t begin = UINT64_MAX, end = 0;
    for (std::uint64_t at = tick; at < end_tick; at += block_rows) {
      const Rows& rows = blocks_[at / block_rows];
      if (rows.count == 0) continue;
      begin = std::min(begin, rows.first);
      end = std::max(end, rows.end());
    }
    begin = std::min(begin, end);
    std::vector<std::uint64_t> owners;
    if (!table.load(begin, end - begin) || !table.loaded("row", owners)) return false;
    assign(owners, begin, tick, end_tick);
    return true;
  }
  /// False when these rows could not be read although the tick could, in a damaged file.
  [[nodiscard]] bool holds(std::uint64_t tick) const {
    return tick >= first_tick_ && tick - first_tick_ < of_tick_.size();
  }
  [[nodiscard]] std::int32_t count(std::uint64_t tick) const {
    return static_cast<std::int32_t>(countOf(tick));
  }
  [[nodiscard]] Row row(std::uint64_t tick, std::int32_t i) const {
    Row row;
    table.get(of_tick_[tick - first_tick_].first + static_cast<std::uint64_t>(i), row);
    return row;
  }

  TableReader<Row> table;

 private:
  struct Rows {
    std::uint64_t first = 0, count = 0;
    [[nodiscard]] std::uint64_t end() const noexcept { return first + count; }
  };

  /// Assigns rows to ticks. Rows that never reached the disk hold UINT64_MAX and belong to no tick,
  /// nor do those of an earlier tick than the one before.
  void assign(const std::vector<std::uint64_t>& owners, std::uint64_t first_row,
              std::uint64_t first_tick, std::uint64_t end_tick) {
    first_tick_ = first_tick;
    of_tick_.assign(end_tick - first_tick, {});
    std::uint64_t last = first_tick;
    for (std::uint64_t i = 0; i < owners.size(); ++i) {
      if (owners[i] < last || owners[i] >= end_tick) continue;
      last = owners[i];
      Rows& rows = of_tick_[owners[i] - first_tick];
      if (rows.count == 0) rows.first = first_row + i;
      if (rows.end() == first_row + i) ++rows.count;
    }
  }
  [[nodiscard]] Rows rowsOf(std::uint64_t tick, std::uint64_t end_tick) const {
    std::uint64_t begin = UINT64_MAX, end = 0;
    for (; tick < end_tick; ++tick) {
      const Rows& rows = of_tick_[tick - first_tick_];
      if (rows.count == 0) continue;
      begin = std::min(begin, rows.first);
      end = std::max(end, rows.end());
    }
    // An empty range lies at the end of the one before it.
    if (begin < end) return {begin, end - begin};
    return {blocks_.empty() ? 0 : blocks_.back().end(), 0};
  }
  [[nodiscard]] std::uint64_t countOf(std::uint64_t tick) const {
    return of_tick_[tick - first_tick_].count;
  }

  std::vector<Rows> blocks_;   ///< per chunk of /ticks
  std::vector<Rows> of_tick_;  ///< per tick from first_tick_ on
  std::uint64_t first_tick_ = 0;
};

}  // namespace wholehand::recording
