#pragma once

#include "telemetry/table_reader.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace wholehand::recording {

/// A table with any number of rows for a tick: its reader, and which rows belong to which tick.
template <class Row>
struct SideTable {
  struct Rows {
    std::uint64_t first = 0, count = 0;
  };
  TableReader<Row> table;
  std::vector<Rows> of_tick;

  /// Takes which tick each row belongs to. Rows that never reached the disk belong to none: they
  /// hold UINT64_MAX, or in older files 0 behind those of later ticks.
  bool assign(std::uint64_t ticks) {
    std::vector<std::uint64_t> owners;
    if (!table.readAll("row", owners)) return false;
    of_tick.assign(ticks, {});
    std::uint64_t last = 0;
    for (std::uint64_t i = 0; i < owners.size(); ++i) {
      if (owners[i] >= ticks || owners[i] < last) continue;
      last = owners[i];
      Rows& rows = of_tick[owners[i]];
      if (rows.count == 0) rows.first = i;
      if (rows.first + rows.count == i) ++rows.count;
    }
    return true;
  }
  /// True where all rows of that tick are there.
  [[nodiscard]] bool isWhole(std::uint64_t tick, std::int32_t count, int most) const {
    return of_tick[tick].count == static_cast<std::uint64_t>(std::clamp(count, 0, most));
  }
  bool load(std::uint64_t tick, std::uint64_t end_tick) {
    std::uint64_t begin = UINT64_MAX, end = 0;
    for (; tick < end_tick; ++tick) {
      const Rows& rows = of_tick[tick];
      if (rows.count == 0) continue;
      begin = std::min(begin, rows.first);
      end = std::max(end, rows.first + rows.count);
    }
    return begin >= end || table.load(begin, end - begin);
  }
  // Of a damaged file the ticks may have been read and these rows not.
  [[nodiscard]] bool holds(std::uint64_t tick) const {
    const Rows& rows = of_tick[tick];
    if (rows.count == 0) return true;
    return table.holds(rows.first) && table.holds(rows.first + rows.count - 1);
  }
  [[nodiscard]] std::int32_t count(std::uint64_t tick) const {
    return static_cast<std::int32_t>(of_tick[tick].count);
  }
  [[nodiscard]] Row row(std::uint64_t tick, std::int32_t i) const {
    Row row;
    table.get(of_tick[tick].first + static_cast<std::uint64_t>(i), row);
    return row;
  }
};

}  // namespace wholehand::recording
