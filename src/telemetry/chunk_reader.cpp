#include "telemetry/chunk_reader.hpp"

#include <algorithm>
#include <bit>
#include <zlib.h>

namespace wholehand::recording {
namespace {

using hdf5::Handle;

constexpr std::size_t kConstant = 64;  ///< bytes that one byte stands for where nothing changes

static_assert(std::endian::native == std::endian::little, "chunks hold little-endian numbers");

H5Z_filter_t filterAt(hid_t properties, unsigned index) {
  unsigned flags = 0, config = 0;
  std::size_t values = 0;
  return H5Pget_filter2(properties, index, &flags, &values, nullptr, 0, nullptr, &config);
}

/// Undoes the "shuffle" filter, which stores the first bytes of all elements, then their second
/// bytes, and so on. Many planes are all zeros.
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

}  // namespace

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
  // An unwritten chunk has no bytes; a damaged file may claim terabytes.
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
  // A constant column has the same few bytes in every chunk; zlib would fill them in one by one.
  if (packed_.size() > bytes / kConstant) {
    return unpackChunk(packed_, hdf5::byteSize(column.type), planes_, rows);
  }
  Unpacked& last = last_[dataset];
  if (last.packed != packed_ || last.rows.size() != bytes) {
    last.rows.resize(bytes);
    last.packed.clear();  // if it is damaged, nothing is kept
    if (!unpackChunk(packed_, hdf5::byteSize(column.type), planes_, last.rows.data())) return false;
    last.packed = packed_;
  }
  std::copy(last.rows.begin(), last.rows.end(), rows);
  return true;
}

}  // namespace wholehand::recording
