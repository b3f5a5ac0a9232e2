#pragma once

#include "telemetry/dataset_rows.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace wholehand::recording {

/// Growing datasets of equal length with their buffered rows. Not for the tick.
template <class Row>
class TableWriter {
 public:
  TableWriter(std::vector<Column<Row>> columns, std::uint64_t chunk_rows)
      : columns_(std::move(columns)), chunk_rows_(chunk_rows), buffers_(columns_.size()) {
    for (const ColumnShape& c : columns_) row_bytes_.push_back(c.rowBytes());
  }
  /// Begins a chunk with every write: a chunk that grows is compressed anew, at another place of
  /// the file. The rows in between stay unwritten.
  void beginChunks() noexcept { begins_chunks_ = true; }

  /// Creates the datasets with their attributes in `group`.
  bool create(hid_t group);
  /// Buffers a row until the next write().
  void push(const Row& row);
  /// Writes the buffered rows after the committed ones, and keeps them: if a later step fails, the
  /// same rows are written to the same place again.
  bool write();
  /// Marks the written rows as safe on disk: drops them from the buffer and continues after them.
  void commit();
  /// Takes over the buffered rows of another table. In a side table, subtracts `ticks`, the number
  /// of tick rows in the other's file, from the tick row numbers.
  void takeRowsOf(TableWriter& other, std::uint64_t ticks);
  /// Closes the datasets.
  void close() { datasets_.clear(); }

  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }
  [[nodiscard]] std::uint64_t pending() const noexcept { return pending_; }
  /// True when the buffered rows complete a chunk: the cheapest time to write.
  [[nodiscard]] bool atChunkEnd() const noexcept {
    return pending_ > 0 && (written_ + pending_) % chunk_rows_ == 0;
  }
  [[nodiscard]] std::uint64_t pendingBytes() const noexcept;

 private:
  std::vector<Column<Row>> columns_;
  std::uint64_t chunk_rows_;
  std::vector<std::size_t> row_bytes_;
  std::vector<std::vector<std::byte>> buffers_;  ///< buffered rows, by column
  std::vector<hdf5::Handle> datasets_;
  std::uint64_t written_ = 0, pending_ = 0;
  bool begins_chunks_ = false;
};

/// Creates an empty dataset, chunked and compressed.
hdf5::Handle createDataset(hid_t group, const ColumnShape& column, std::uint64_t chunk_rows);

template <class Row>
bool TableWriter<Row>::create(hid_t group) {
  for (const Column<Row>& column : columns_) {
    datasets_.push_back(createDataset(group, column, chunk_rows_));
    if (!datasets_.back().ok()) return false;
  }
  return true;
}

template <class Row>
void TableWriter<Row>::push(const Row& row) {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const std::size_t bytes = row_bytes_[i];
    std::vector<std::byte>& buffer = buffers_[i];
    buffer.resize(buffer.size() + bytes);
    columns_[i].store(row, buffer.data() + buffer.size() - bytes);
  }
  ++pending_;
}

template <class Row>
bool TableWriter<Row>::write() {
  if (pending_ == 0) return true;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (!writeRows(datasets_[i].get(), columns_[i], written_, pending_, buffers_[i].data())) {
      return false;
    }
  }
  return true;
}

template <class Row>
void TableWriter<Row>::commit() {
  written_ += pending_;
  if (begins_chunks_) written_ += (chunk_rows_ - written_ % chunk_rows_) % chunk_rows_;
  pending_ = 0;
  for (std::vector<std::byte>& rows : buffers_) rows.clear();
}

template <class Row>
void TableWriter<Row>::takeRowsOf(TableWriter& other, std::uint64_t ticks) {
  buffers_.swap(other.buffers_);
  std::swap(pending_, other.pending_);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    if (columns_[i].name != "row") continue;
    for (std::size_t at = 0; at < buffers_[i].size(); at += sizeof(std::uint64_t)) {
      std::uint64_t row = 0;
      std::memcpy(&row, buffers_[i].data() + at, sizeof row);
      row -= ticks;
      std::memcpy(buffers_[i].data() + at, &row, sizeof row);
    }
  }
}

template <class Row>
std::uint64_t TableWriter<Row>::pendingBytes() const noexcept {
  std::uint64_t n = 0;
  for (const std::size_t bytes : row_bytes_) n += bytes;
  return n * pending_;
}

}  // namespace wholehand::recording
