#pragma once

#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording_layout.hpp"

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <vector>

/// Rows of a table's dataset in an HDF5 file. Private to telemetry.
namespace wholehand::recording {

/// Dimensions of a dataset: rows x the row's own dimensions.
[[nodiscard]] std::vector<hsize_t> dimensions(const ColumnShape& column, std::uint64_t rows);

/// Reads `count` rows from row `first` of a dataset.
bool readRows(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
              std::byte* rows);
/// Writes `count` rows at row `first` of a dataset, which grows if needed.
bool writeRows(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
               const std::byte* rows);

}  // namespace wholehand::recording
