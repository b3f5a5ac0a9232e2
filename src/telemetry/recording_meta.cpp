#include "telemetry/recording_meta.hpp"

#include "telemetry/meta_fields.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace wholehand::recording {
namespace {

using hdf5::Handle;

class Writer {
 public:
  explicit Writer(hid_t id) : id_(id) {}
  bool operator()(const char* name, bool value) const {
    return hdf5::writeAttribute(id_, name, std::uint64_t{value ? 1U : 0U});
  }
  bool operator()(const char* name, int value) const {
    return hdf5::writeAttribute(id_, name, static_cast<std::uint64_t>(std::max(value, 0)));
  }
  template <class T>
  bool operator()(const char* name, const T& value) const {
    return hdf5::writeAttribute(id_, name, value);
  }

 private:
  hid_t id_;
};

class Reader {
 public:
  Reader(hid_t id, std::string& missing) : id_(id), missing_(missing) {}
  bool operator()(const char* name, bool& value) const {
    std::uint64_t number = 0;
    const bool ok = (*this)(name, number);
    value = number != 0;
    return ok;
  }
  bool operator()(const char* name, int& value) const {
    constexpr std::uint64_t kMost = 1000;  // of a damaged file, too
    std::uint64_t number = 0;
    const bool ok = (*this)(name, number);
    value = static_cast<int>(std::min(number, kMost));
    return ok;
  }
  template <class T>
  bool operator()(const char* name, T& value) const {
    const bool ok = hdf5::readAttribute(id_, name, value);
    if (!ok) missing_ = name;
    return ok;
  }

 private:
  hid_t id_;
  std::string& missing_;
};

bool readFiles(hid_t file, RecordingMeta& meta) {
  const Handle group(H5Gopen2(file, "meta/files", H5P_DEFAULT), H5Gclose);
  H5G_info_t info{};
  if (!group.ok() || H5Gget_info(group.get(), &info) < 0) return false;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    std::string name, text;
    if (!hdf5::readText(group.get(), std::to_string(i).c_str(), name, text)) return false;
    meta.files.emplace_back(std::move(name), std::move(text));
  }
  return true;
}

}  // namespace

bool writeMeta(hid_t file, const RecordingMeta& meta) {
  const Handle group(H5Gcreate2(file, "meta", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  const hid_t id = group.get();
  bool ok = group.ok() && hdf5::writeAttribute(id, "format", std::string(kFormat)) &&
            hdf5::writeAttribute(id, "schema_version", kRecordingSchema) &&
            visitMeta(Writer(id), meta);
  const Handle files(H5Gcreate2(file, "meta/files", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Gclose);
  for (std::size_t i = 0; ok && i < meta.files.size(); ++i) {
    const auto& [name, text] = meta.files[i];
    ok = hdf5::writeText(files.get(), std::to_string(i).c_str(), name, text);
  }
  return ok && files.ok();
}

bool hasVariableText(hid_t file) {
  const Handle meta(H5Gopen2(file, "meta", H5P_DEFAULT), H5Gclose);
  if (!meta.ok()) return false;
  if (hdf5::hasVariableText(meta.get())) return true;
  const Handle files(H5Gopen2(file, "meta/files", H5P_DEFAULT), H5Gclose);
  H5G_info_t info{};
  if (!files.ok() || H5Gget_info(files.get(), &info) < 0) return false;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const Handle text(H5Dopen2(files.get(), std::to_string(i).c_str(), H5P_DEFAULT), H5Dclose);
    if (text.ok() && (hdf5::isVariableText(text.get()) || hdf5::hasVariableText(text.get()))) {
      return true;
    }
  }
  return false;
}

std::string readMeta(hid_t file, hid_t id, RecordingMeta& meta) {
  std::string missing;
  if (!visitMeta(Reader(id, missing), meta)) return "'" + missing + "' of /meta";
  return readFiles(file, meta) ? "" : "the texts in /meta/files";
}

}  // namespace wholehand::recording
