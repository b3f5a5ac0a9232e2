#include "record/hdf5_tables.hpp"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>
#include <zlib.h>

namespace wholehand::recording {
namespace {

using hdf5::Handle;

/// Selection of rows within a dataset, and the space of the same rows in memory.
struct RowSpaces {
  Handle in_file, in_memory;
  bool ok = false;
};

RowSpaces selectRows(hid_t dataset, const ColumnShape& column, std::uint64_t first,
                     std::uint64_t count) {
  const std::vector<hsize_t> block = dimensions(column, count);
  std::vector<hsize_t> start(block.size(), 0);
  start.front() = first;
  RowSpaces spaces;
  spaces.in_file = Handle(H5Dget_space(dataset), H5Sclose);
  spaces.in_memory =
      Handle(H5Screate_simple(static_cast<int>(block.size()), block.data(), nullptr), H5Sclose);
  spaces.ok = H5Sselect_hyperslab(spaces.in_file.get(), H5S_SELECT_SET, start.data(), nullptr,
                                  block.data(), nullptr) >= 0;
  return spaces;
}

/// A chunk compressed by more than this factor counts as constant.
constexpr std::size_t kConstant = 64;

static_assert(std::endian::native == std::endian::little, "chunks hold little-endian numbers");

H5Z_filter_t filterAt(hid_t properties, unsigned index) {
  unsigned flags = 0, config = 0;
  std::size_t values = 0;
  return H5Pget_filter2(properties, index, &flags, &values, nullptr, 0, nullptr, &config);
}

/// Reverses the "shuffle" filter, which stores the first bytes of all elements, then their second
/// bytes, and so on. Many of these planes contain only zeros.
void unshuffle(const std::vector<std::byte>& planes, std::size_t element_bytes, std::byte* out) {
  const std::size_t elements = planes.size() / element_bytes;
  std::fill_n(out, planes.size(), std::byte{0});
  for (std::size_t b = 0; b < element_bytes; ++b) {
    const std::byte* plane = planes.data() + b * elements;
    const bool is_zero =
        plane[0] == std::byte{0} && std::equal(plane, plane + elements - 1, plane + 1);
    if (is_zero) continue;
    for (std::size_t i = 0; i < elements; ++i) out[i * element_bytes + b] = plane[i];
  }
}

/// Compression level. Level 1 makes files 10 % larger; level 9 makes them 2 % smaller and takes 50
/// % more time.
constexpr unsigned kDeflateLevel = 6;

Handle creationProperties(const ColumnShape& column, std::uint64_t chunk_rows) {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const std::vector<hsize_t> chunk = dimensions(column, chunk_rows);
  H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data());
  H5Pset_shuffle(properties.get());
  H5Pset_deflate(properties.get(), kDeflateLevel);
  if (column.name == "tick" || column.name == "row") {
    // The fill value marks rows that never reached the disk; 0 would be confused with tick 0.
    H5Pset_fill_value(properties.get(), hdf5::fileType(column.type), &kNeverWritten);
  }
  return properties;
}

/// An open dataset.
struct Dataset {
  Handle handle;
  std::uint64_t rows = 0;
  std::uint64_t chunk_rows = 0;  ///< ChunkReader::chunkRows()
};

std::string openDataset(hid_t group, const ColumnShape& column, Dataset& dataset) {
  std::string missing = "has no dataset '" + column.name + "'";
  if (H5Lexists(group, column.name.c_str(), H5P_DEFAULT) <= 0) return missing;
  dataset.handle = Handle(H5Dopen2(group, column.name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.handle.ok()) return missing;
  const Handle space(H5Dget_space(dataset.handle.get()), H5Sclose);
  const Handle type(H5Dget_type(dataset.handle.get()), H5Tclose);
  const std::vector<hsize_t> expected = dimensions(column, 0);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank != static_cast<int>(expected.size()) ||
      H5Tequal(type.get(), hdf5::fileType(column.type)) <= 0) {
    return "has a dataset '" + column.name + "' of another form";
  }
  std::vector<hsize_t> dims(expected.size());
  H5Sget_simple_extent_dims(space.get(), dims.data(), nullptr);
  if (!std::equal(expected.begin() + 1, expected.end(), dims.begin() + 1)) {
    return "has a dataset '" + column.name + "' with another number of columns than /meta names";
  }
  dataset.rows = dims.front();
  dataset.chunk_rows = ChunkReader::chunkRows(dataset.handle.get(), column);
  return {};
}

class Hdf5Table final : public TableSource {
 public:
  explicit Hdf5Table(Handle group) : group_(std::move(group)) {}

  std::string open(const ColumnShape& column, std::uint64_t& rows) override {
    Dataset& dataset = datasets_.emplace_back();
    std::string problem = openDataset(group_.get(), column, dataset);
    rows = dataset.rows;
    return problem;
  }
  bool read(std::size_t i, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
            std::byte* rows) override {
    const Dataset& dataset = datasets_[i];
    const hid_t id = dataset.handle.get();
    for (; dataset.chunk_rows > 0 && first % dataset.chunk_rows == 0 &&
           count >= dataset.chunk_rows && chunks_.read(id, column, first, dataset.chunk_rows, rows);
         first += dataset.chunk_rows, count -= dataset.chunk_rows) {
      rows += dataset.chunk_rows * column.rowBytes();
    }
    return count == 0 || readRows(id, column, first, count, rows);
  }

 private:
  Handle group_;
  std::vector<Dataset> datasets_;
  ChunkReader chunks_;
};

}  // namespace

std::vector<hsize_t> dimensions(const ColumnShape& column, std::uint64_t rows) {
  std::vector<hsize_t> dims = {rows};
  dims.insert(dims.end(), column.shape.begin(), column.shape.end());
  return dims;
}

bool readRows(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
              std::byte* rows) {
  const RowSpaces spaces = selectRows(dataset, column, first, count);
  return spaces.ok && H5Dread(dataset, hdf5::memoryType(column.type), spaces.in_memory.get(),
                              spaces.in_file.get(), H5P_DEFAULT, rows) >= 0;
}

bool writeRows(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
               const std::byte* rows) {
  const std::vector<hsize_t> size = dimensions(column, first + count);
  if (H5Dset_extent(dataset, size.data()) < 0) return false;
  const RowSpaces spaces = selectRows(dataset, column, first, count);
  return spaces.ok && H5Dwrite(dataset, hdf5::memoryType(column.type), spaces.in_memory.get(),
                               spaces.in_file.get(), H5P_DEFAULT, rows) >= 0;
}

std::uint64_t ChunkReader::chunkRows(hid_t dataset, const ColumnShape& column) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  const std::vector<std::uint64_t>& shape = column.shape;
  const int rank = static_cast<int>(shape.size()) + 1;
  std::vector<hsize_t> chunk(shape.size() + 1);
  if (!properties.ok() || H5Pget_layout(properties.get()) != H5D_CHUNKED ||
      H5Pget_chunk(properties.get(), rank, chunk.data()) != rank ||
      !std::equal(shape.begin(), shape.end(), chunk.begin() + 1) ||
      H5Pget_nfilters(properties.get()) != 2 ||
      filterAt(properties.get(), 0) != H5Z_FILTER_SHUFFLE ||
      filterAt(properties.get(), 1) != H5Z_FILTER_DEFLATE) {
    return 0;
  }
  return chunk.front();
}

bool unpackChunk(const std::vector<std::byte>& packed, std::size_t element_bytes,
                 std::vector<std::byte>& planes, std::byte* rows) {
  uLongf length = planes.size();
  if (uncompress(reinterpret_cast<Bytef*>(planes.data()), &length,
                 reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK ||
      length != planes.size()) {
    return false;
  }
  unshuffle(planes, element_bytes, rows);
  return true;
}

bool ChunkReader::read(hid_t dataset, const ColumnShape& column, std::uint64_t first,
                       std::uint64_t chunk_rows, std::byte* rows) {
  const std::size_t bytes = chunk_rows * column.rowBytes();
  std::vector<hsize_t> offset(column.shape.size() + 1, 0);
  offset.front() = first;
  hsize_t stored = 0;
  // An unwritten chunk has no bytes. A damaged file may claim terabytes.
  if (H5Dget_chunk_storage_size(dataset, offset.data(), &stored) < 0 || stored == 0 ||
      stored > compressBound(bytes)) {
    return false;
  }
  packed_.resize(stored);
  planes_.resize(bytes);
  std::uint32_t left_out_filters = 0;
  if (H5Dread_chunk(dataset, H5P_DEFAULT, offset.data(), &left_out_filters, packed_.data()) < 0 ||
      left_out_filters != 0) {
    return false;
  }
  // A constant column has the same few bytes in every chunk. Its unpacked chunk is reused, because
  // zlib would expand it byte by byte.
  if (packed_.size() > bytes / kConstant) {
    return unpackChunk(packed_, hdf5::byteSize(column.type), planes_, rows);
  }
  UnpackedChunk& last = last_[dataset];
  if (last.packed != packed_ || last.rows.size() != bytes) {
    last.rows.resize(bytes);
    last.packed.clear();  // a damaged chunk must not be reused
    if (!unpackChunk(packed_, hdf5::byteSize(column.type), planes_, last.rows.data())) return false;
    last.packed = packed_;
  }
  std::copy(last.rows.begin(), last.rows.end(), rows);
  return true;
}

Handle createDataset(hid_t group, const ColumnShape& column, std::uint64_t chunk_rows) {
  std::vector<hsize_t> most = dimensions(column, H5S_UNLIMITED);
  const std::vector<hsize_t> none = dimensions(column, 0);
  const Handle space(H5Screate_simple(static_cast<int>(none.size()), none.data(), most.data()),
                     H5Sclose);
  // The cache must hold the chunk that is being filled, or a partial write reads the chunk back.
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.get(), 521,
                     std::max<std::size_t>(column.rowBytes() * chunk_rows * 2, 1U << 16U), 1.0);
  Handle dataset(
      H5Dcreate2(group, column.name.c_str(), hdf5::fileType(column.type), space.get(), H5P_DEFAULT,
                 creationProperties(column, chunk_rows).get(), access.get()),
      H5Dclose);
  if (!dataset.ok()) return {};
  const hid_t id = dataset.get();
  // A device with one axis has lists of one unit and one label.
  const bool one_unit = column.units.size() == 1 && column.labels.size() != 1;
  const bool done = (one_unit ? hdf5::writeAttribute(id, "units", column.units.front())
                              : hdf5::writeAttribute(id, "units", column.units)) &&
                    (column.labels.empty() || hdf5::writeAttribute(id, "labels", column.labels)) &&
                    (column.columns.empty() || hdf5::writeAttribute(id, "columns", column.columns));
  return done ? std::move(dataset) : Handle();
}

std::unique_ptr<TableSource> Hdf5Tables::table(const std::string& name) {
  if (H5Lexists(file_, name.c_str(), H5P_DEFAULT) <= 0) return nullptr;
  Handle group(H5Gopen2(file_, name.c_str(), H5P_DEFAULT), H5Gclose);
  if (!group.ok()) return nullptr;
  return std::make_unique<Hdf5Table>(std::move(group));
}

std::uint64_t Hdf5Tables::bytes() {
  hsize_t bytes = 0;
  return H5Fget_filesize(file_, &bytes) >= 0 ? bytes : 0;
}

}  // namespace wholehand::recording
