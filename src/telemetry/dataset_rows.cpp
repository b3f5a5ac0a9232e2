#include "telemetry/dataset_rows.hpp"

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

}  // namespace wholehand::recording
