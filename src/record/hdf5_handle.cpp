#include "record/hdf5_handle.hpp"

#include <algorithm>
#include <cstring>

namespace wholehand::hdf5 {
namespace {

/// Limit larger than any text in a recording, so that a damaged file causes no huge allocation.
constexpr std::uint64_t kLargestText = std::uint64_t{1} << 31U;
/// Limit larger than any list of names.
constexpr std::uint64_t kLargestList = std::uint64_t{1} << 24U;
constexpr hssize_t kLongestList = 100000;

/// Type of a fixed-length UTF-8 text, zero-padded.
Handle textType(std::size_t bytes) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), std::max<std::size_t>(bytes, 1));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

Handle listSpace(std::size_t size) {
  const hsize_t n = size;
  return {H5Screate_simple(1, &n, nullptr), H5Sclose};
}

bool writeRaw(hid_t object, const char* name, hid_t file_type, hid_t memory_type,
              const Handle& space, const void* data) {
  const Handle attribute(H5Acreate2(object, name, file_type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  return attribute.ok() && H5Awrite(attribute.get(), memory_type, data) >= 0;
}

/// Opens an attribute of the given class and returns its number of elements.
Handle openAttribute(hid_t object, const char* name, H5T_class_t wanted, hssize_t& count) {
  if (H5Aexists(object, name) <= 0) return {};
  Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!attribute.ok()) return {};
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  if (!type.ok() || !space.ok() || H5Tget_class(type.get()) != wanted) return {};
  count = H5Sget_simple_extent_npoints(space.get());
  return count >= 0 && count <= kLongestList ? std::move(attribute) : Handle();
}

bool readScalar(hid_t object, const char* name, H5T_class_t wanted, hid_t memory_type, void* out) {
  hssize_t count = 0;
  const Handle attribute = openAttribute(object, name, wanted, count);
  return attribute.ok() && count == 1 && H5Aread(attribute.get(), memory_type, out) >= 0;
}

bool writeTexts(hid_t object, const char* name, const Handle& space,
                const std::vector<std::string>& texts) {
  std::size_t width = 1;
  for (const std::string& text : texts) width = std::max(width, text.size());
  std::string data(width * std::max<std::size_t>(texts.size(), 1), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) {
    std::copy(texts[i].begin(), texts[i].end(), data.begin() + static_cast<long>(i * width));
  }
  const Handle type = textType(width);
  return writeRaw(object, name, type.get(), type.get(), space, data.data());
}

/// Copies texts of variable length that HDF5 allocated.
std::vector<std::string> copied(const std::vector<char*>& pointers, std::size_t count) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < count; ++i) {
    texts.emplace_back(pointers[i] != nullptr ? pointers[i] : "");
  }
  return texts;
}

struct TypePair {
  hid_t file, memory;
};
TypePair typesOf(NumberType type) noexcept {
  switch (type) {
    case NumberType::kFloat32:
      return {H5T_IEEE_F32LE, H5T_NATIVE_FLOAT};
    case NumberType::kFloat64:
      return {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE};
    case NumberType::kUint64:
      return {H5T_STD_U64LE, H5T_NATIVE_UINT64};
    case NumberType::kInt64:
      return {H5T_STD_I64LE, H5T_NATIVE_INT64};
    case NumberType::kUint32:
      return {H5T_STD_U32LE, H5T_NATIVE_UINT32};
    case NumberType::kInt32:
      return {H5T_STD_I32LE, H5T_NATIVE_INT32};
  }
  return {H5I_INVALID_HID, H5I_INVALID_HID};
}

}  // namespace

void beginHdf5() noexcept {
  static const bool kOnce = H5dont_atexit() >= 0;
  (void)kOnce;
  H5Eset_auto2(H5E_DEFAULT, nullptr,
               nullptr);  // applies to one thread only: Debian's HDF5 is thread-safe
}

hid_t fileType(NumberType type) noexcept {
  return typesOf(type).file;
}

hid_t memoryType(NumberType type) noexcept {
  return typesOf(type).memory;
}

std::size_t byteSize(NumberType type) noexcept {
  const bool is_long =
      type == NumberType::kFloat64 || type == NumberType::kUint64 || type == NumberType::kInt64;
  return is_long ? 8 : 4;
}

bool writeAttribute(hid_t object, const char* name, const std::string& text) {
  return writeTexts(object, name, {H5Screate(H5S_SCALAR), H5Sclose}, {text});
}

bool writeAttribute(hid_t object, const char* name, const std::vector<std::string>& texts) {
  return writeTexts(object, name, listSpace(texts.size()), texts);
}

bool writeAttribute(hid_t object, const char* name, const std::vector<double>& values) {
  std::vector<double> data = values;
  data.push_back(0.0);
  return writeRaw(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, listSpace(values.size()),
                  data.data());
}

bool writeAttribute(hid_t object, const char* name, double value) {
  return writeRaw(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE,
                  {H5Screate(H5S_SCALAR), H5Sclose}, &value);
}

bool writeAttribute(hid_t object, const char* name, std::uint64_t value) {
  return writeRaw(object, name, H5T_STD_U64LE, H5T_NATIVE_UINT64, {H5Screate(H5S_SCALAR), H5Sclose},
                  &value);
}

bool readAttribute(hid_t object, const char* name, std::string& text) {
  std::vector<std::string> texts;
  if (!readAttribute(object, name, texts) || texts.size() != 1) return false;
  text = std::move(texts.front());
  return true;
}

bool readAttribute(hid_t object, const char* name, std::vector<std::string>& texts) {
  hssize_t count = 0;
  const Handle attribute = openAttribute(object, name, H5T_STRING, count);
  if (!attribute.ok()) return false;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const std::size_t size = count;
  if (H5Tis_variable_str(type.get()) > 0) {
    const Handle space(H5Aget_space(attribute.get()), H5Sclose);
    std::vector<char*> pointers(std::max<std::size_t>(size, 1), nullptr);
    if (H5Aread(attribute.get(), type.get(), pointers.data()) < 0) return false;
    texts = copied(pointers, size);
    H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, pointers.data());
    return true;
  }
  const std::size_t width = H5Tget_size(type.get());
  if (width == 0 || width > kLargestList / std::max<std::size_t>(size, 1)) return false;
  std::string data(width * std::max<std::size_t>(size, 1), '\0');
  if (size > 0 && H5Aread(attribute.get(), type.get(), data.data()) < 0) return false;
  texts.clear();
  for (std::size_t i = 0; i < size; ++i) {
    texts.push_back(data.substr(i * width, width));
    texts.back().erase(texts.back().find_last_not_of('\0') + 1);
  }
  return true;
}

bool hasVariableText(hid_t object) {
  const auto is_variable = [](hid_t owner, const char* name, const H5A_info_t*, void*) -> herr_t {
    const Handle attribute(H5Aopen(owner, name, H5P_DEFAULT), H5Aclose);
    const Handle type(H5Aget_type(attribute.get()), H5Tclose);
    return type.ok() && H5Tis_variable_str(type.get()) > 0 ? 1 : 0;  // 1 ends the search
  };
  return H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, is_variable, nullptr) > 0;
}

bool isVariableText(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  return type.ok() && H5Tis_variable_str(type.get()) > 0;
}

bool readAttribute(hid_t object, const char* name, std::vector<double>& values) {
  hssize_t count = 0;
  const Handle attribute = openAttribute(object, name, H5T_FLOAT, count);
  if (!attribute.ok()) return false;
  values.assign(count + 1, 0.0);
  const bool done = H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, values.data()) >= 0;
  values.resize(count);
  return done;
}

bool readAttribute(hid_t object, const char* name, double& value) {
  return readScalar(object, name, H5T_FLOAT, H5T_NATIVE_DOUBLE, &value);
}

bool readAttribute(hid_t object, const char* name, std::uint64_t& value) {
  return readScalar(object, name, H5T_INTEGER, H5T_NATIVE_UINT64, &value);
}

bool writeText(hid_t group, const char* name, const std::string& attribute_name,
               const std::string& text) {
  // A fixed-length string stores arbitrary bytes including zeros, because a mesh may be binary.
  const Handle type = textType(text.size());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle dataset(
      H5Dcreate2(group, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose);
  return dataset.ok() &&
         H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) >= 0 &&
         writeAttribute(dataset.get(), "name", attribute_name) &&
         writeAttribute(dataset.get(), "bytes", static_cast<std::uint64_t>(text.size()));
}

bool readText(hid_t group, const char* name, std::string& attribute_name, std::string& text) {
  const Handle dataset(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose);
  if (!dataset.ok() || !readAttribute(dataset.get(), "name", attribute_name)) return false;
  const Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const Handle space(H5Dget_space(dataset.get()), H5Sclose);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Sget_simple_extent_npoints(space.get()) != 1) {
    return false;
  }
  if (H5Tis_variable_str(type.get()) > 0) {
    std::vector<char*> pointer(1, nullptr);
    if (H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, pointer.data()) < 0) {
      return false;
    }
    text = copied(pointer, 1).front();
    H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, pointer.data());
    return true;
  }
  std::uint64_t bytes = 0;
  if (!readAttribute(dataset.get(), "bytes", bytes) || bytes > kLargestText ||
      H5Tget_size(type.get()) != std::max<std::uint64_t>(bytes, 1)) {
    return false;
  }
  text.assign(std::max<std::uint64_t>(bytes, 1), '\0');
  const bool done =
      H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) >= 0;
  text.resize(bytes);
  return done;
}

}  // namespace wholehand::hdf5
