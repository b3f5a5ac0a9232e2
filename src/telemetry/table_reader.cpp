#include "telemetry/table_reader.hpp"

namespace wholehand::recording {
namespace {

using hdf5::Handle;

bool readByHdf5(hid_t dataset, const ColumnShape& column, std::uint64_t first, std::uint64_t count,
                std::byte* rows) {
  const std::vector<std::uint64_t> shape = column.fileShape();
  std::vector<hsize_t> block = {count};
  block.insert(block.end(), shape.begin(), shape.end());
  std::vector<hsize_t> start(block.size(), 0);
  start.front() = first;
  const Handle in_file(H5Dget_space(dataset), H5Sclose);
  const Handle in_memory(H5Screate_simple(static_cast<int>(block.size()), block.data(), nullptr),
                         H5Sclose);
  return H5Sselect_hyperslab(in_file.get(), H5S_SELECT_SET, start.data(), nullptr, block.data(),
                             nullptr) >= 0 &&
         H5Dread(dataset, elementType(column, true).get(), in_memory.get(), in_file.get(),
                 H5P_DEFAULT, rows) >= 0;
}

}  // namespace

std::string openDataset(hid_t group, const ColumnShape& column, Dataset& dataset) {
  std::string missing = "has no dataset '" + column.name + "'";
  if (H5Lexists(group, column.name.c_str(), H5P_DEFAULT) <= 0) return missing;
  dataset.handle = Handle(H5Dopen2(group, column.name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!dataset.handle.ok()) return missing;
  const Handle space(H5Dget_space(dataset.handle.get()), H5Sclose);
  const Handle type(H5Dget_type(dataset.handle.get()), H5Tclose);
  const std::vector<std::uint64_t> shape = column.fileShape();
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank != static_cast<int>(shape.size()) + 1 ||
      H5Tequal(type.get(), elementType(column, false).get()) <= 0) {
    return "has a dataset '" + column.name + "' of another form";
  }
  std::vector<hsize_t> dims(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), dims.data(), nullptr);
  if (!std::equal(shape.begin(), shape.end(), dims.begin() + 1)) {
    return "has a dataset '" + column.name + "' with another number of columns than /meta names";
  }
  dataset.rows = dims.front();
  dataset.chunk_rows = ChunkReader::chunkRows(dataset.handle.get(), column);
  return {};
}

bool readRows(const Dataset& dataset, const ColumnShape& column, std::uint64_t first,
              std::uint64_t count, ChunkReader& chunks, std::vector<std::byte>& rows) {
  const hid_t id = dataset.handle.get();
  rows.resize(count * column.rowBytes());
  std::byte* to = rows.data();
  for (; dataset.chunk_rows > 0 && first % dataset.chunk_rows == 0 && count >= dataset.chunk_rows &&
         chunks.read(id, column, first, dataset.chunk_rows, to);
       first += dataset.chunk_rows, count -= dataset.chunk_rows) {
    to += dataset.chunk_rows * column.rowBytes();
  }
  return count == 0 || readByHdf5(id, column, first, count, to);
}

}  // namespace wholehand::recording
