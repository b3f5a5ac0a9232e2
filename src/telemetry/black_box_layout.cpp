#include "telemetry/black_box_layout.hpp"

#include "telemetry/meta_fields.hpp"

#include <cstring>

namespace wholehand::black_box {
namespace {

/// Appends values to a byte array.
class Packer {
 public:
  bool operator()(const std::string& text) {
    number(text.size());
    append(text.data(), text.size());
    return true;
  }
  template <class T>
  bool operator()(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    append(&value, sizeof value);
    return true;
  }
  template <class A, class B>
  bool operator()(const std::pair<A, B>& pair) {
    return (*this)(pair.first) && (*this)(pair.second);
  }
  template <class T>
  bool operator()(const std::vector<T>& list) {
    number(list.size());
    for (const T& item : list) (*this)(item);
    return true;
  }
  std::vector<std::byte> bytes;

 private:
  void number(std::uint64_t n) { (*this)(n); }
  void append(const void* from, std::size_t count) {
    const auto* first = static_cast<const std::byte*>(from);
    bytes.insert(bytes.end(), first, first + count);
  }
};

/// Reads them back; each call says whether the value was present.
class Unpacker {
 public:
  Unpacker(const std::byte* at, std::size_t bytes) : at_(at), left_(bytes) {}

  bool operator()(std::string& text) {
    std::uint64_t size = 0;
    if (!(*this)(size) || size > left_) return false;
    text.assign(reinterpret_cast<const char*>(at_), size);
    skip(size);
    return true;
  }
  template <class T>
  bool operator()(T& value) {
    static_assert(std::is_arithmetic_v<T>);
    if (left_ < sizeof value) return false;
    std::memcpy(&value, at_, sizeof value);
    skip(sizeof value);
    return true;
  }
  bool operator()(bool& value) {
    std::uint8_t byte = 0;
    if (!(*this)(byte)) return false;
    value = byte != 0;
    return true;
  }
  template <class A, class B>
  bool operator()(std::pair<A, B>& pair) {
    return (*this)(pair.first) && (*this)(pair.second);
  }
  template <class T>
  bool operator()(std::vector<T>& list) {
    std::uint64_t size = 0;
    if (!(*this)(size) || size > left_) return false;  // an item has at least one byte
    list.clear();
    for (std::uint64_t i = 0; i < size; ++i) {
      if (!(*this)(list.emplace_back())) return false;
    }
    return true;
  }
  [[nodiscard]] bool atEnd() const { return left_ == 0; }

 private:
  void skip(std::size_t count) {
    at_ += count;
    left_ -= count;
  }
  const std::byte* at_;
  std::size_t left_;
};

}  // namespace

std::vector<std::byte> packMeta(const RecordingMeta& meta) {
  Packer packer;
  recording::visitMeta([&packer](const char*, const auto& value) { return packer(value); }, meta);
  packer(meta.files);
  return std::move(packer.bytes);
}

bool unpackMeta(const std::byte* in, std::size_t bytes, RecordingMeta& meta) {
  Unpacker unpacker(in, bytes);
  return recording::visitMeta([&unpacker](const char*, auto& value) { return unpacker(value); },
                              meta) &&
         unpacker(meta.files) && unpacker.atEnd();
}

}  // namespace wholehand::black_box
