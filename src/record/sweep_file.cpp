#include "record/sweep_file.hpp"

#include "files/text/text_file.hpp"
#include "record/hdf5_handle.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <system_error>
#include <unistd.h>

namespace wholehand {
namespace {

using hdf5::Handle;

constexpr const char* kKind = "wholehand-sweep";
constexpr std::uint64_t kVersion = 1;

/// Creation properties without time stamps, so that equal contents give equal bytes.
Handle datasetWithoutTimes() {
  Handle list(::H5Pcreate(H5P_DATASET_CREATE), ::H5Pclose);
  ::H5Pset_obj_track_times(list.get(), false);
  return list;
}

Handle createGroup(hid_t in, const char* name) {
  const Handle list(::H5Pcreate(H5P_GROUP_CREATE), ::H5Pclose);
  ::H5Pset_obj_track_times(list.get(), false);
  return {::H5Gcreate2(in, name, H5P_DEFAULT, list.get(), H5P_DEFAULT), ::H5Gclose};
}

bool writeNumbers(hid_t group, const std::string& name, const std::vector<hsize_t>& extent,
                  const std::vector<double>& values) {
  const Handle space(::H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr),
                     ::H5Sclose);
  const Handle list = datasetWithoutTimes();
  const Handle set(::H5Dcreate2(group, name.c_str(), hdf5::fileType(hdf5::NumberType::kFloat64),
                                space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT),
                   ::H5Dclose);
  return set.ok() && ::H5Dwrite(set.get(), hdf5::memoryType(hdf5::NumberType::kFloat64), H5S_ALL,
                                H5S_ALL, H5P_DEFAULT, values.data()) >= 0;
}

/// Texts of fixed length, padded with zeros.
bool writeTexts(hid_t group, const std::string& name, const std::vector<std::string>& texts) {
  std::size_t longest = 1;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  std::string bytes;
  for (std::string text : texts) {
    text.resize(longest, '\0');
    bytes += text;
  }
  const Handle type(::H5Tcopy(H5T_C_S1), ::H5Tclose);
  ::H5Tset_size(type.get(), longest);
  ::H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  ::H5Tset_cset(type.get(), H5T_CSET_UTF8);
  const hsize_t count = texts.size();
  const Handle space(::H5Screate_simple(1, &count, nullptr), ::H5Sclose);
  const Handle list = datasetWithoutTimes();
  const Handle set(::H5Dcreate2(group, name.c_str(), type.get(), space.get(), H5P_DEFAULT,
                                list.get(), H5P_DEFAULT),
                   ::H5Dclose);
  return set.ok() &&
         ::H5Dwrite(set.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) >= 0;
}

bool writeAxes(hid_t file, const std::vector<SweepFile::Axis>& axes) {
  std::vector<std::string> order;
  const Handle group = createGroup(file, "axes");
  for (const SweepFile::Axis& axis : axes) {
    order.push_back(axis.name);
    const bool written = axis.names.empty() ? writeNumbers(group.get(), axis.name,
                                                           {axis.numbers.size()}, axis.numbers)
                                            : writeTexts(group.get(), axis.name, axis.names);
    if (!written) return false;
  }
  return hdf5::writeAttribute(group.get(), "order", order);
}

bool writeAll(hid_t file, const SweepFile& sweep) {
  bool written = hdf5::writeAttribute(file, "kind", std::string(kKind)) &&
                 hdf5::writeAttribute(file, "version", kVersion) &&
                 hdf5::writeAttribute(file, "trial", sweep.trial) &&
                 hdf5::writeAttribute(file, "digest", sweep.digest) &&
                 hdf5::writeAttribute(file, "git_version", sweep.git_version) &&
                 writeTexts(file, "grid", {sweep.grid}) && writeAxes(file, sweep.axes);
  std::vector<hsize_t> extent;
  for (const SweepFile::Axis& axis : sweep.axes) {
    extent.push_back(axis.names.empty() ? axis.numbers.size() : axis.names.size());
  }
  const Handle figures = createGroup(file, "figures");
  for (std::size_t i = 0; i < sweep.figures.size(); ++i) {
    written = written && writeNumbers(figures.get(), sweep.figures[i], extent, sweep.values[i]);
  }
  return written;
}

Diagnostic cannotWrite(const std::string& path) {
  return fileFault(path, "cannot be written", "is the disk full, or the folder read-only?");
}

/// Opens a sweep file; the error says what the file is instead.
Expected<Handle> openSweep(const std::string& path) {
  hdf5::beginHdf5();
  Handle file(::H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), ::H5Fclose);
  std::string kind;
  std::uint64_t version = 0;
  if (!file.ok() || !hdf5::readAttribute(file.get(), "kind", kind) || kind != kKind) {
    return fileFault(path, "is no file of a sweep", "name another file for the results");
  }
  if (!hdf5::readAttribute(file.get(), "version", version) || version != kVersion) {
    return keyFault(path, "version", std::to_string(version), "is not known to this program",
                    "name another file for the results");
  }
  return file;
}

}  // namespace

Expected<Done> writeSweepFile(const SweepFile& sweep, const std::string& path) {
  hdf5::beginHdf5();
  const std::string temporary = path + "." + randomName() + ".tmp";
  bool written = false;
  {
    const Handle file(::H5Fcreate(temporary.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT),
                      ::H5Fclose);
    written =
        file.ok() && writeAll(file.get(), sweep) && ::H5Fflush(file.get(), H5F_SCOPE_GLOBAL) >= 0;
  }
  if (written && renameDurably(temporary, path) == 0) return Done{};
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  return cannotWrite(path);
}

Expected<std::string> readSweepDigest(const std::string& path) {
  auto file = openSweep(path);
  if (!file) return file.errors();
  std::string digest;
  hdf5::readAttribute(file->get(), "digest", digest);
  return digest;
}

Expected<std::vector<std::vector<double>>> readSweepValues(
    const std::string& path, const std::vector<std::string>& figures) {
  auto file = openSweep(path);
  if (!file) return file.errors();
  std::vector<std::vector<double>> all;
  for (const std::string& figure : figures) {
    const Handle set(::H5Dopen2(file->get(), ("figures/" + figure).c_str(), H5P_DEFAULT),
                     ::H5Dclose);
    const Handle space(set.ok() ? ::H5Dget_space(set.get()) : H5I_INVALID_HID, ::H5Sclose);
    const hssize_t count = space.ok() ? ::H5Sget_simple_extent_npoints(space.get()) : 0;
    std::vector<double>& values = all.emplace_back(count);
    if (count <= 0 || ::H5Dread(set.get(), hdf5::memoryType(hdf5::NumberType::kFloat64), H5S_ALL,
                                H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
      return Diagnostic{path, 0, figure, "", "cannot be read", "remove the file and sweep again"};
    }
  }
  return all;
}

}  // namespace wholehand
