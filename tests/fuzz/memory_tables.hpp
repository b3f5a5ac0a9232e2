#pragma once

#include "record/hdf5_tables.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// The tables of a recording in memory, instead of an HDF5 file.
namespace wholehand::test {

using recording::ColumnShape;
using recording::TableSource;
using recording::TablesSource;

inline constexpr std::uint64_t kBlockRows = 25;  ///< rows of a chunk

struct MemoryDataset {
  std::uint64_t rows = 0;
  std::size_t row_bytes = 0, element_bytes = 0;
  std::vector<std::byte> bytes;
  std::uint64_t unreadable_chunk = UINT64_MAX;
};

/// The datasets of a recording by "table/name".
using MemoryTables = std::map<std::string, MemoryDataset>;

class MemoryTable final : public TableSource {
 public:
  MemoryTable(MemoryTables& all, std::string name) : all_(all), name_(std::move(name)) {}

  std::string open(const ColumnShape& column, std::uint64_t& rows) override {
    const auto found = all_.find(name_ + "/" + column.name);
    if (found == all_.end()) return "has no dataset '" + column.name + "'";
    MemoryDataset& dataset = found->second;
    dataset.row_bytes = column.rowBytes();  // HDF5 would have refused another shape
    rows = dataset.rows;
    opened_.push_back(&dataset);
    return {};
  }
  /// Rows that were not stored repeat the stored ones.
  bool read(std::size_t i, const ColumnShape&, std::uint64_t first, std::uint64_t count,
            std::byte* rows) override {
    const MemoryDataset& dataset = *opened_.at(i);
    if (first + count > dataset.rows || first + count < first)
      std::abort();  // the reader broke the @pre
    const std::uint64_t unreadable = dataset.unreadable_chunk;
    if (count > 0 && first / kBlockRows <= unreadable &&
        unreadable <= (first + count - 1) / kBlockRows) {
      return false;
    }
    const std::size_t bytes = dataset.bytes.size();
    if (bytes == 0) return count == 0;
    std::size_t at = first * dataset.row_bytes % bytes;
    for (std::size_t left = count * dataset.row_bytes; left > 0; at = 0) {
      const std::size_t n = std::min(left, bytes - at);
      std::memcpy(rows, dataset.bytes.data() + at, n);
      rows += n;
      left -= n;
    }
    return true;
  }

 private:
  MemoryTables& all_;
  const std::string name_;
  std::vector<MemoryDataset*> opened_;
};

class MemorySource final : public TablesSource {
 public:
  explicit MemorySource(MemoryTables& all) : all_(all) {}
  std::unique_ptr<TableSource> table(const std::string& name) override {
    return std::make_unique<MemoryTable>(all_, name);
  }
  std::uint64_t bytes() override { return 100'000; }

 private:
  MemoryTables& all_;
};

/// Keeps the data that HDF5 reads of each opened dataset.
class CapturedTable final : public TableSource {
 public:
  CapturedTable(std::unique_ptr<TableSource> from, std::string name, MemoryTables& to)
      : from_(std::move(from)), name_(std::move(name)), to_(to) {}
  std::string open(const ColumnShape& column, std::uint64_t& rows) override {
    std::string problem = from_->open(column, rows);
    MemoryDataset& dataset = to_[name_ + "/" + column.name];
    dataset = {rows, column.rowBytes(), hdf5::byteSize(column.type), {}, UINT64_MAX};
    dataset.bytes.resize(rows * column.rowBytes());
    if (rows > 0) (void)from_->read(opened_, column, 0, rows, dataset.bytes.data());
    ++opened_;
    return problem;
  }
  bool read(std::size_t i, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
            std::byte* rows) override {
    return from_->read(i, column, first, count, rows);
  }

 private:
  std::unique_ptr<TableSource> from_;
  const std::string name_;
  MemoryTables& to_;
  std::size_t opened_ = 0;
};

class CapturedTables final : public TablesSource {
 public:
  CapturedTables(hid_t file, MemoryTables& to) : from_(file), to_(to) {}
  std::unique_ptr<TableSource> table(const std::string& name) override {
    return std::make_unique<CapturedTable>(from_.table(name), name, to_);
  }
  std::uint64_t bytes() override { return from_.bytes(); }

 private:
  recording::Hdf5Tables from_;
  MemoryTables& to_;
};

}  // namespace wholehand::test
