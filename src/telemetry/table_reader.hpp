#pragma once

#include "telemetry/recording_layout.hpp"
#include "telemetry/table_source.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::recording {

/// Reads the datasets of a TableWriter, block by block. Not for the tick.
template <class Row>
class TableReader {
 public:
  explicit TableReader(std::vector<Column<Row>> columns)
      : columns_(std::move(columns)), left_out_(columns_.size()), buffers_(columns_.size()) {
    for (const ColumnShape& c : columns_) row_bytes_.push_back(c.rowBytes());
  }
  /// Skips these columns, which the file need not have: their numbers are zero. Before open().
  void leaveOut(const std::vector<std::string>& names);

  /// Opens every dataset of the table. Returns the error, or an empty text.
  std::string open(std::unique_ptr<TableSource> source);
  /// What the datasets contradict each other in, or which one of those left out is missing; empty:
  /// nothing. E.g. "has 99 rows of 'sent', 100 of 'tick'".
  [[nodiscard]] const std::string& flaw() const noexcept { return flaw_; }
  /// Number of rows that every dataset has: after a killed writer some are a little longer.
  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }
  /// Loads the rows first .. first+count-1 for get().
  bool load(std::uint64_t first, std::uint64_t count);
  /// Copies the i-th row of the file. @pre it is loaded
  void get(std::uint64_t i, Row& row) const;
  [[nodiscard]] bool holds(std::uint64_t i) const noexcept {
    return i >= first_ && i < first_ + count_;
  }
  /// Reads a dataset by name, one number of type T per row. What cannot be read is `unknown`,
  /// `step` rows at a time. Returns how many these are.
  template <class T>
  std::uint64_t readSound(const std::string& name, std::uint64_t step, T unknown,
                          std::vector<T>& out);
  /// The loaded rows of a dataset by name. @pre as readSound()
  template <class T>
  bool loaded(const std::string& name, std::vector<T>& out) const;
  /// One number of the i-th row by its dataset; T() where it is left out. @pre as readSound(),
  /// loaded
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
  std::unique_ptr<TableSource> source_;  ///< its i-th dataset is the i-th column's
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

}  // namespace wholehand::recording
