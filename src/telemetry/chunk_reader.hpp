#pragma once

#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording_layout.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

/// Reads whole chunks past HDF5's own pipeline, which copies every byte four times and asks for
/// memory with each chunk (docs/adr/0038-whole-chunks-are-read-directly.md). Private to telemetry.
namespace wholehand::recording {

class ChunkReader {
 public:
  /// How many rows a chunk of the dataset has; 0 where its chunks are not as our writer makes them:
  /// only HDF5 reads those.
  static std::uint64_t chunkRows(hid_t dataset, const ColumnShape& column);

  /// Reads a whole chunk into `rows`. False where that fails, of whatever reason: HDF5 then reads
  /// it, or tells that it is damaged. @pre chunk_rows is chunkRows(dataset, column), > 0; `first`
  /// is a multiple of it; `rows` has room for a chunk
  bool read(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t chunk_rows,
            std::byte* rows);

 private:
  std::vector<std::byte> packed_, planes_;
};

}  // namespace wholehand::recording
