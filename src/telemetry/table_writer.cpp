#include "telemetry/table_writer.hpp"

#include <algorithm>

namespace wholehand::recording {
namespace {

using hdf5::Handle;

/// Level 1 makes files a tenth larger, level 9 one in fifty smaller for half as much time again.
constexpr unsigned kDeflateLevel = 6;

Handle creationProperties(const ColumnShape& column, std::uint64_t chunk_rows) {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const std::vector<hsize_t> chunk = dimensions(column, chunk_rows);
  H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data());
  H5Pset_shuffle(properties.get());
  H5Pset_deflate(properties.get(), kDeflateLevel);
  if (column.name == "tick" || column.name == "row") {
    // A row whose numbers never reached the disk can be told from tick 0, and from rows of tick 0.
    const std::uint64_t never = UINT64_MAX;
    H5Pset_fill_value(properties.get(), H5T_NATIVE_UINT64, &never);
  }
  return properties;
}

}  // namespace

Handle createDataset(hid_t group, const ColumnShape& column, std::uint64_t chunk_rows) {
  std::vector<hsize_t> most = dimensions(column, H5S_UNLIMITED);
  const std::vector<hsize_t> none = dimensions(column, 0);
  const Handle space(H5Screate_simple(static_cast<int>(none.size()), none.data(), most.data()),
                     H5Sclose);
  // The cache must hold the one chunk that is being filled, else a partial write reads it back.
  const Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
  H5Pset_chunk_cache(access.get(), 521,
                     std::max<std::size_t>(column.rowBytes() * chunk_rows * 2, 1U << 16U), 1.0);
  Handle dataset(
      H5Dcreate2(group, column.name.c_str(), hdf5::fileType(column.type), space.get(), H5P_DEFAULT,
                 creationProperties(column, chunk_rows).get(), access.get()),
      H5Dclose);
  if (!dataset.ok()) return {};
  const hid_t id = dataset.get();
  // A device of one axis has lists of one.
  const bool one_unit = column.units.size() == 1 && column.labels.size() != 1;
  const bool done = (one_unit ? hdf5::writeAttribute(id, "units", column.units.front())
                              : hdf5::writeAttribute(id, "units", column.units)) &&
                    (column.labels.empty() || hdf5::writeAttribute(id, "labels", column.labels)) &&
                    (column.columns.empty() || hdf5::writeAttribute(id, "columns", column.columns));
  return done ? std::move(dataset) : Handle();
}

}  // namespace wholehand::recording
