#pragma once

#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording_layout.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace wholehand::recording {

/// Growing datasets of equal length, with the rows that are not on the disk yet. Not for the tick.
template <class Row>
class TableWriter {
 public:
  TableWriter(std::vector<Column<Row>> columns, std::uint64_t chunk_rows)
      : columns_(std::move(columns)), chunk_rows_(chunk_rows), buffers_(columns_.size()) {}

  /// Creates the datasets with their attributes in `group`.
  bool create(hid_t group);
  /// Keeps a row until the next write().
  void push(const Row& row);
  /// Writes the kept rows behind the committed ones. They are kept still: when a later step fails,
  /// the same rows are written to the same place once more.
  bool write();
  /// The written rows are safe: forgets them and goes on behind them.
  void commit();
  /// Takes the rows that another keeps. Those of a side table name their tick by its row: it loses
  /// the `ticks` that the other's file had.
  void takeRowsOf(TableWriter& other, std::uint64_t ticks);
  /// Closes the datasets.
  void close() { datasets_.clear(); }

  [[nodiscard]] std::uint64_t written() const noexcept { return written_; }
  [[nodiscard]] std::uint64_t pending() const noexcept { return pending_; }
  /// True when the kept rows reach the end of a chunk: the moment at which writing is cheapest.
  [[nodiscard]] bool atChunkEnd() const noexcept {
    return pending_ > 0 && (written_ + pending_) % chunk_rows_ == 0;
  }
  [[nodiscard]] std::uint64_t pendingBytes() const noexcept;

 private:
  std::vector<Column<Row>> columns_;
  std::uint64_t chunk_rows_;
  std::vector<std::vector<std::byte>> buffers_;
  std::vector<hdf5::Handle> datasets_;
  std::uint64_t written_ = 0, pending_ = 0;
};

/// Creates one dataset, chunked and compressed, without rows.
hdf5::Handle createDataset(hid_t group, const ColumnShape& column, std::uint64_t chunk_rows);
/// Writes `count` rows at row `first` of a dataset, which grows when needed.
bool writeRows(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
               const std::byte* rows);

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
    const std::size_t bytes = columns_[i].rowBytes();
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
  for (auto& buffer : buffers_) buffer.clear();
  pending_ = 0;
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
  for (const auto& buffer : buffers_) n += buffer.size();
  return n;
}

}  // namespace wholehand::recording
