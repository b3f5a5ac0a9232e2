#pragma once

#include "telemetry/recording_layout.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

/// What the readers of a recording's tables need of its file. Private to telemetry.
namespace wholehand::recording {

/// The datasets of one table.
class TableSource {
 public:
  virtual ~TableSource() = default;

  /// Opens a column's dataset and checks the type and shape of its rows. Returns the error, or an
  /// empty text.
  virtual std::string open(const ColumnShape& column, std::uint64_t& rows) = 0;
  /// Reads `count` rows from row `first` of the i-th dataset opened, that of `column`. False where
  /// it is damaged. @pre `rows` has room for them
  virtual bool read(std::size_t i, const ColumnShape& column, std::uint64_t first,
                    std::uint64_t count, std::byte* rows) = 0;
};

/// The tables of a recording: of an HDF5 file, or bytes in a test.
class TablesSource {
 public:
  virtual ~TablesSource() = default;

  /// A table by its name; null when there is none.
  virtual std::unique_ptr<TableSource> table(const std::string& name) = 0;
  /// Size of the whole file [bytes]; 0 when it cannot be told.
  virtual std::uint64_t bytes() = 0;
};

}  // namespace wholehand::recording
