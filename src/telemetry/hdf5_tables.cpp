#include "telemetry/hdf5_tables.hpp"

#include "telemetry/chunk_reader.hpp"
#include "telemetry/dataset_rows.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace wholehand::recording {
namespace {

using hdf5::Handle;

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
