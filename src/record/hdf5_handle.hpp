#pragma once

#include <hdf5.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

/// Wrappers with owning handles for the part of HDF5 that recordings need. Private to src/record:
/// no public header exposes HDF5.
namespace wholehand::hdf5 {

/// Signature of every HDF5 file (format specification, superblock).
inline constexpr std::array<char, 8> kSignature = {'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};

/// Owns one HDF5 identifier. Not real-time safe.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);

  Handle() noexcept = default;
  Handle(hid_t id, Closer closer) noexcept : id_(id), closer_(closer) {}
  Handle(Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), closer_(other.closer_) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      id_ = std::exchange(other.id_, H5I_INVALID_HID);
      closer_ = other.closer_;
    }
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { reset(); }

  void reset() noexcept {
    if (ok()) closer_(std::exchange(id_, H5I_INVALID_HID));
  }
  [[nodiscard]] bool ok() const noexcept { return id_ >= 0; }
  [[nodiscard]] hid_t get() const noexcept { return id_; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer closer_ = nullptr;
};

/// Initialises HDF5; every public function of the recorder calls it first. Disables HDF5's error
/// output for the calling thread, because errors become a Diagnostic or are counted. Disables the
/// closing of files at exit, because HDF5 1.10 crashes on a file after the disk refused its writes.
void beginHdf5() noexcept;

/// Type of a number in the file (little-endian) and in memory.
enum class NumberType { kFloat32, kFloat64, kUint64, kInt64, kUint32, kInt32 };
[[nodiscard]] hid_t fileType(NumberType type) noexcept;
[[nodiscard]] hid_t memoryType(NumberType type) noexcept;
[[nodiscard]] std::size_t byteSize(NumberType type) noexcept;

// Attributes. Functions return false on any failure. Texts are written as UTF-8 of fixed length,
// zero-padded to the longest of a list; texts of any length are read. Lists are one-dimensional.
bool writeAttribute(hid_t object, const char* name, const std::string& text);
bool writeAttribute(hid_t object, const char* name, const std::vector<std::string>& texts);
bool writeAttribute(hid_t object, const char* name, const std::vector<double>& values);
bool writeAttribute(hid_t object, const char* name, double value);
bool writeAttribute(hid_t object, const char* name, std::uint64_t value);
bool readAttribute(hid_t object, const char* name, std::string& text);
bool readAttribute(hid_t object, const char* name, std::vector<std::string>& texts);
bool readAttribute(hid_t object, const char* name, std::vector<double>& values);
bool readAttribute(hid_t object, const char* name, double& value);
bool readAttribute(hid_t object, const char* name, std::uint64_t& value);
/// True when an attribute of the object is a text of variable length. HDF5 1.10 stores these in a
/// heap without checksums and crashes if the heap is damaged, so this program never writes them.
[[nodiscard]] bool hasVariableText(hid_t object);
/// True for a dataset of such a text.
[[nodiscard]] bool isVariableText(hid_t dataset);

/// Writes a scalar dataset that holds a whole text, or arbitrary bytes, exactly.
bool writeText(hid_t group, const char* name, const std::string& attribute_name,
               const std::string& text);
/// Reads a dataset written by writeText() or a text dataset written by h5py.
bool readText(hid_t group, const char* name, std::string& attribute_name, std::string& text);

}  // namespace wholehand::hdf5
