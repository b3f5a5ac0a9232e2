#pragma once

#include "telemetry/table_source.hpp"

#include <hdf5.h>

#include <cstdint>
#include <memory>
#include <string>

namespace wholehand::recording {

/// The tables of an open HDF5 file. Private to telemetry.
class Hdf5Tables final : public TablesSource {
 public:
  /// @pre the file stays open as long as a table of it
  explicit Hdf5Tables(hid_t file) : file_(file) {}

  std::unique_ptr<TableSource> table(const std::string& name) override;
  std::uint64_t bytes() override;

 private:
  hid_t file_;
};

}  // namespace wholehand::recording
