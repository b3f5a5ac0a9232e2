#pragma once

#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording_layout.hpp"

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

/// Reads whole chunks directly, bypassing HDF5's pipeline, which copies every byte four times and
/// allocates memory per chunk (docs/adr/0074-plain-recordings.md). Private to
/// telemetry.
namespace wholehand::recording {

/// Undoes deflate and shuffle, in this order. False when the block is damaged or holds another
/// number of bytes than `planes`, its buffer. @pre planes is not empty, a multiple of
/// `element_bytes`; `rows` has room for it
[[nodiscard]] bool unpackChunk(const std::vector<std::byte>& packed, std::size_t element_bytes,
                               std::vector<std::byte>& planes, std::byte* rows);

class ChunkReader {
 public:
  /// Rows per chunk of the dataset; 0 when its chunks are not in our writer's format: then only
  /// HDF5 can read them.
  static std::uint64_t chunkRows(hid_t dataset, const ColumnShape& column);

  /// Reads a whole chunk into `rows`. False on any failure: then HDF5 must read it, or report the
  /// damage. @pre chunk_rows is chunkRows(dataset, column), > 0; `first` is a multiple of it;
  /// `rows` has room for a chunk
  bool read(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t chunk_rows,
            std::byte* rows);

 private:
  struct Unpacked {
    std::vector<std::byte> packed, rows;
  };
  std::vector<std::byte> packed_, planes_;
  std::unordered_map<hid_t, Unpacked> last_;  ///< last chunk of few bytes, per dataset
};

}  // namespace wholehand::recording
