#pragma once

#include "record/hdf5_handle.hpp"
#include "record/recording_layout.hpp"
#include "record/table_reader.hpp"

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

/// The tables of a recording as datasets of an HDF5 file. Private to src/record.
namespace wholehand::recording {

/// Dimensions of a dataset: rows x the row's own dimensions.
[[nodiscard]] std::vector<hsize_t> dimensions(const ColumnShape& column, std::uint64_t rows);

/// Creates an empty dataset, chunked and compressed.
hdf5::Handle createDataset(hid_t group, const ColumnShape& column, std::uint64_t chunk_rows);
/// Reads `count` rows from row `first` of a dataset.
bool readRows(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
              std::byte* rows);
/// Writes `count` rows at row `first` of a dataset, which grows if needed.
bool writeRows(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
               const std::byte* rows);

/// Reverses deflate and shuffle, in this order. Returns false when the block is damaged or does not
/// unpack to exactly the size of the buffer `planes`. @pre planes is not empty and a multiple of
/// `element_bytes`; `rows` has room for it
[[nodiscard]] bool unpackChunk(const std::vector<std::byte>& packed, std::size_t element_bytes,
                               std::vector<std::byte>& planes, std::byte* rows);

/// Reads whole chunks directly without HDF5's pipeline, which copies every byte four times and
/// allocates memory per chunk (docs/adr/0074-plain-hdf5-recordings.md).
class ChunkReader {
 public:
  /// Rows per chunk of the dataset; 0 when its chunks are not in this program's format and only
  /// HDF5 can read them.
  static std::uint64_t chunkRows(hid_t dataset, const ColumnShape& column);

  /// Reads a whole chunk into `rows`. Returns false on any failure; HDF5 must then read it or
  /// report the damage. @pre chunk_rows is chunkRows(dataset, column), > 0; `first` is a multiple
  /// of it; `rows` has room for a chunk
  bool read(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t chunk_rows,
            std::byte* rows);

 private:
  struct UnpackedChunk {
    std::vector<std::byte> packed, rows;
  };
  std::vector<std::byte> packed_, planes_;
  std::unordered_map<hid_t, UnpackedChunk> last_;  ///< last constant chunk, per dataset
};

/// The tables of an open HDF5 file.
class Hdf5Tables final : public TablesSource {
 public:
  /// @pre the file stays open as long as any of its tables is in use
  explicit Hdf5Tables(hid_t file) : file_(file) {}

  std::unique_ptr<TableSource> table(const std::string& name) override;
  std::uint64_t bytes() override;

 private:
  hid_t file_;
};

}  // namespace wholehand::recording
