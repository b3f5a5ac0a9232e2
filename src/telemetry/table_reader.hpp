#pragma once

#include "telemetry/prediction.hpp"
#include "telemetry/recording_layout.hpp"
#include "telemetry/table_source.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
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
  /// Unpacks these columns, chunk by chunk. Before open().
  void unpack(std::vector<Prediction> predictions, std::uint64_t chunk_rows) {
    predictions_ = std::move(predictions);
    chunk_rows_ = chunk_rows;
    for (const Prediction& p : predictions_) {
      columns_[p.column].packed = true;
      columns_[p.column].row_elements = p.row_elements;
    }
  }

  /// Skips these columns: their numbers are zero. Before load(). A column that the prediction of a
  /// read column uses must not be among them.
  void leaveOut(const std::vector<std::string>& names);

  /// Opens every dataset of the table. Returns the error, or an empty text.
  std::string open(std::unique_ptr<TableSource> source);
  /// Number of rows that every dataset has: after a killed writer some are a little longer.
  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }
  /// Loads the rows first .. first+count-1 for get(). @pre when columns are packed, first is the
  /// first row of a chunk
  bool load(std::uint64_t first, std::uint64_t count);
  /// Copies the i-th row of the file. @pre it is loaded
  void get(std::uint64_t i, Row& row) const;
  [[nodiscard]] bool holds(std::uint64_t i) const noexcept {
    return i >= first_ && i < first_ + count_;
  }
  /// Reads `count` rows of a dataset by name. False when they cannot be read. @pre one number of
  /// type T per row, not packed; first + count <= rows()
  template <class T>
  bool read(const std::string& name, std::uint64_t first, std::uint64_t count, std::vector<T>& out);
  /// The loaded rows of a dataset by name. @pre as read()
  template <class T>
  bool loaded(const std::string& name, std::vector<T>& out) const;

 private:
  bool readColumn(std::size_t c, std::uint64_t first, std::uint64_t count,
                  std::vector<std::byte>& rows) {
    rows.resize(count * row_bytes_[c]);
    return source_->read(c, columns_[c], first, count, rows.data());
  }

  std::vector<Column<Row>> columns_;
  std::vector<std::size_t> row_bytes_;
  std::vector<bool> left_out_;
  std::vector<Prediction> predictions_;
  std::uint64_t chunk_rows_ = 1;
  RowBytes buffers_;
  std::unique_ptr<TableSource> source_;  ///< its i-th dataset is the i-th column's
  std::uint64_t rows_ = 0, first_ = 0, count_ = 0;
};

template <class Row>
std::string TableReader<Row>::open(std::unique_ptr<TableSource> source) {
  source_ = std::move(source);
  rows_ = UINT64_MAX;
  for (const Column<Row>& column : columns_) {
    std::uint64_t rows = 0;
    std::string problem = source_->open(column, rows);
    if (!problem.empty()) return problem;
    rows_ = std::min(rows_, rows);
  }
  return {};
}

template <class Row>
void TableReader<Row>::leaveOut(const std::vector<std::string>& names) {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (std::find(names.begin(), names.end(), columns_[c].name) != names.end()) left_out_[c] = true;
  }
  std::erase_if(predictions_, [this](const Prediction& p) { return left_out_[p.column]; });
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
  unpackRows(predictions_, buffers_, row_bytes_, chunk_rows_, count);
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
bool TableReader<Row>::read(const std::string& name, std::uint64_t first, std::uint64_t count,
                            std::vector<T>& out) {
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    if (columns_[c].name != name) continue;
    std::vector<std::byte> bytes;
    if (!readColumn(c, first, count, bytes)) return false;
    copyNumbers(bytes, out);
    return true;
  }
  return false;
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
