#include "telemetry/black_box_layout.hpp"

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

/// Every field in file order.
template <class Archive, class Meta, class Steps>
bool visit(Archive& a, Meta& m, Steps& encoder_step) {
  return a(m.created_utc) && a(m.git_version) && a(m.seed) && a(m.period_s) && a(m.engine) &&
         a(m.simulated_clock) && a(m.uncertified) && a(m.paper) && a(m.simulated_device) &&
         a(m.title) && a(m.axis_names) && a(m.axis_units) && a(m.effort_limits) &&
         a(m.lever_arms_m) && a(m.armed_position) && a(m.joint_names) && a(m.body_names) &&
         a(m.capsule_names) && a(m.exercise) && a(m.level) && a(m.parameter_names) &&
         a(m.value_names) && a(m.event_names) && a(m.parameter_values) && a(m.files) &&
         a(encoder_step);
}

}  // namespace

std::vector<std::byte> packMeta(RecordingMeta meta, std::vector<double> encoder_step) {
  Packer packer;
  visit(packer, meta, encoder_step);
  packer(meta.models_changed);
  packer(meta.passport);
  return std::move(packer.bytes);
}

bool unpackMeta(const std::byte* in, std::size_t bytes, RecordingMeta& meta,
                std::vector<double>& encoder_step) {
  Unpacker unpacker(in, bytes);
  if (!visit(unpacker, meta, encoder_step)) return false;
  if (unpacker.atEnd()) return true;  // an older file ends here
  if (!unpacker(meta.models_changed)) return false;
  return unpacker.atEnd() || (unpacker(meta.passport) && unpacker.atEnd());
}

}  // namespace wholehand::black_box
