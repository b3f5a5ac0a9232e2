#pragma once

#include "record/recording_layout.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// Reads the tables of a recording from a source. Private to src/record.
namespace wholehand::recording {

/// The datasets of one table.
class TableSource {
 public:
  virtual ~TableSource() = default;

  /// Opens a column's dataset and checks the type and shape of its rows. Returns the error, or an
  /// empty text.
  virtual std::string open(const ColumnShape& column, std::uint64_t& rows) = 0;
  /// Reads `count` rows from row `first` of the i-th opened dataset, which belongs to `column`.
  /// Returns false if it is damaged. @pre `rows` has room for them
  virtual bool read(std::size_t i, const ColumnShape& column, std::uint64_t first,
                    std::uint64_t count, std::byte* rows) = 0;
};

/// Source of the tables of a recording: an HDF5 file, or bytes in a test.
class TablesSource {
 public:
  virtual ~TablesSource() = default;

  /// A table by its name; null when there is none.
  virtual std::unique_ptr<TableSource> table(const std::string& name) = 0;
  /// Size of the whole file [bytes]; 0: unknown.
  virtual std::uint64_t bytes() = 0;
};

/// Reads the datasets of a TableWriter block by block. Not real-time safe.
template <class Row>
class TableReader {
 public:
  explicit TableReader(std::vector<Column<Row>> columns)
      : columns_(std::move(columns)), left_out_(columns_.size()), buffers_(columns_.size()) {
    for (const ColumnShape& c : columns_) row_bytes_.push_back(c.rowBytes());
  }
  /// Skips these columns, which may be missing in the file; their numbers are zero. Call it before
  /// open().
  void leaveOut(const std::vector<std::string>& names);

  /// Opens every dataset of the table. Returns the error, or an empty text.
  std::string open(std::unique_ptr<TableSource> source);
  /// Contradiction between the datasets, or the name of a skipped dataset that is missing; empty:
  /// none. Example: "has 99 rows of 'sent', 100 of 'tick'".
  [[nodiscard]] const std::string& flaw() const noexcept { return flaw_; }
  /// Number of rows that every dataset has. After a killed writer some datasets are slightly
  /// longer.
  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }
  /// Loads the rows first .. first+count-1 for get().
  bool load(std::uint64_t first, std::uint64_t count);
  /// Copies the i-th row of the file. @pre it is loaded
  void get(std::uint64_t i, Row& row) const;
  [[nodiscard]] bool holds(std::uint64_t i) const noexcept {
    return i >= first_ && i < first_ + count_;
  }
  /// Reads a dataset by name, one number of type T per row, in steps of `step` rows. Rows of an
  /// unreadable step get `unknown`. Returns the number of these rows.
  template <class T>
  std::uint64_t readSound(const std::string& name, std::uint64_t step, T unknown,
                          std::vector<T>& out);
  /// The loaded rows of a dataset by name. @pre as readSound()
  template <class T>
  bool loaded(const std::string& name, std::vector<T>& out) const;
  /// One number of the i-th row by its dataset; T() if the dataset is left out. @pre as
  /// readSound(); the row is loaded
  template <class T>
  [[nodiscard]] T number(const std::string& name, std::uint64_t i) const;

 private:
  bool readColumn(std::size_t c, std::uint64_t first, std::uint64_t count,
                  std::vector<std::byte>& rows) {
    rows.resize(count * row_bytes_[c]);
    return source_->read(c, columns_[c], first, count, rows.data());
  }

  std::vector<Column<Row>> columns_;
  std::vector<std::size_t> row_bytes_;
  std::vector<bool> left_out_;
  std::vector<std::vector<std::byte>> buffers_;
  std::unique_ptr<TableSource> source_;  ///< its i-th dataset belongs to the i-th column
  std::uint64_t rows_ = 0, first_ = 0, count_ = 0;
  std::string flaw_;
};

template <class Row>
std::string TableReader<Row>::open(std::unique_ptr<TableSource> source) {
  source_ = std::move(source);
  rows_ = UINT64_MAX;
  std::uint64_t most = 0;
  std::string shortest, longest;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    std::uint64_t rows = 0;
    std::string problem = source_->open(columns_[c], rows);
    if (!problem.empty()) {
      if (!left_out_[c]) return problem;
      flaw_ = problem;
      continue;
    }
    if (rows < rows_) shortest = columns_[c].name;
    if (rows > most) longest = columns_[c].name;
    rows_ = std::min(rows_, rows);
    most = std::max(most, rows);
  }
  if (rows_ < most) {
    flaw_ = "has " + std::to_string(rows_) + " rows of '" + shortest + "', " +
            std::to_string(most) + " of '" + longest + "'";
  }
  return {};
}

template <class Row>
void TableReader<Row>::leaveOut(const std::vector<std::string>& names) {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (std::find(names.begin(), names.end(), columns_[c].name) != names.end()) left_out_[c] = true;
  }
}

template <class Row>
bool TableReader<Row>::load(std::uint64_t first, std::uint64_t count) {
  count_ = 0;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (left_out_[i]) {
      buffers_[i].resize(count * row_bytes_[i]);
    } else if (!readColumn(i, first, count, buffers_[i])) {
      return false;
    }
  }
  first_ = first;
  count_ = count;
  return true;
}

template <class Row>
void TableReader<Row>::get(std::uint64_t i, Row& row) const {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (left_out_[c]) continue;
    columns_[c].load(buffers_[c].data() + (i - first_) * row_bytes_[c], row);
  }
}

template <class T>
void copyNumbers(const std::vector<std::byte>& bytes, std::vector<T>& out) {
  out.resize(bytes.size() / sizeof(T));
  std::copy_n(bytes.data(), out.size() * sizeof(T), reinterpret_cast<std::byte*>(out.data()));
}

template <class Row>
template <class T>
std::uint64_t TableReader<Row>::readSound(const std::string& name, std::uint64_t step, T unknown,
                                          std::vector<T>& out) {
  out.assign(rows_, unknown);
  std::uint64_t unread = 0;
  std::vector<std::byte> bytes;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].name != name || left_out_[c]) continue;
    if (readColumn(c, 0, rows_, bytes)) {
      copyNumbers(bytes, out);
      return 0;
    }
    for (std::uint64_t first = 0; first < rows_; first += step) {
      const std::uint64_t count = std::min(step, rows_ - first);
      if (readColumn(c, first, count, bytes)) {
        std::copy_n(bytes.data(), bytes.size(), reinterpret_cast<std::byte*>(out.data() + first));
      } else {
        unread += count;
      }
    }
  }
  return unread;
}

template <class Row>
template <class T>
T TableReader<Row>::number(const std::string& name, std::uint64_t i) const {
  T value{};
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].name != name || left_out_[c]) continue;
    std::memcpy(&value, buffers_[c].data() + (i - first_) * row_bytes_[c], sizeof value);
  }
  return value;
}

template <class Row>
template <class T>
bool TableReader<Row>::loaded(const std::string& name, std::vector<T>& out) const {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].name != name) continue;
    copyNumbers(buffers_[c], out);
    return true;
  }
  return false;
}

/// A table with any number of rows per tick: its reader, and the assignment of rows to ticks.
template <class Row>
class SideTable {
 public:
  explicit SideTable(std::vector<Column<Row>> columns) : table(std::move(columns)) {}

  /// Finds the rows of every block of `block_rows` rows of /ticks. Their assignment to ticks is
  /// valid until the next load(). Unreadable rows belong to no tick.
  void findBlocks(std::uint64_t ticks, std::uint64_t block_rows) {
    std::vector<std::uint64_t> owners;
    table.readSound("row", kContactChunkRows, kNeverWritten, owners);
    assign(owners, 0, 0, ticks);
    for (std::uint64_t tick = 0; tick < ticks; tick += block_rows) {
      blocks_.push_back(rowsOf(tick, std::min(ticks, tick + block_rows)));
    }
  }
  /// True when all rows of that tick are present. @pre the tick was found or loaded
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

  /// Assigns rows to ticks. Rows that never reached the disk hold kNeverWritten and belong to none;
  /// rows of an earlier tick than their predecessor belong to no tick either.
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
    // An empty range lies at the end of the previous range.
    if (begin < end) return {begin, end - begin};
    return {blocks_.empty() ? 0 : blocks_.back().end(), 0};
  }
  [[nodiscard]] std::uint64_t countOf(std::uint64_t tick) const {
    return of_tick_[tick - first_tick_].count;
  }

  std::vector<Rows> blocks_;   ///< row range per chunk of /ticks
  std::vector<Rows> of_tick_;  ///< row range per tick, beginning with first_tick_
  std::uint64_t first_tick_ = 0;
};

}  // namespace wholehand::recording
