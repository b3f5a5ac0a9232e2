#include "loop/core/record_packing.hpp"

#include "loop/core/crc32.hpp"
#include "loop/core/record_fields.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <type_traits>
#include <vector>

namespace wholehand {
namespace {

/// Bytes of the record that the fields cover.
constexpr std::size_t coveredBytes() {
  std::size_t bytes = 0;
  visitFields(kRecordFields, [&bytes](const auto& field) {
    using Of = std::remove_cvref_t<decltype(field.of)>;
    using Value = std::remove_cvref_t<std::invoke_result_t<Of, TickRecord&>>;
    if constexpr (kIsItems<Value>) {
      bytes += sizeof(field.of.array(std::declval<TickRecord&>()));
    } else {
      bytes += sizeof(Value);
    }
  });
  return bytes;
}
// The count of placements is followed by an unused number, two others by 4 bytes of padding.
static_assert(sizeof(TickRecord) == coveredBytes() + sizeof(BodyPlacements::reserved) + 2 * 4,
              "a field of TickRecord is missing in kRecordFields");
static_assert(kMaxJoints <= 255, "a size is kept in one byte");

}  // namespace

std::size_t packRecord(const TickRecord& record, std::byte* out) noexcept {
  std::byte* at = out;
  const auto put = [&at](const void* from, std::size_t bytes) {
    std::memcpy(at, from, bytes);
    at += bytes;
  };
  visitFields(kRecordFields, [&](const auto& field) {
    const auto& value = field.of(record);
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (kIsItems<Value>) {
      const auto n = static_cast<std::size_t>(std::clamp(value.count, 0, value.capacity));
      put(value.data, n * sizeof *value.data);
    } else if constexpr (kIsTaggedArray<Value>) {
      const auto n = static_cast<std::size_t>(std::clamp(value.size(), 0, Value::capacity()));
      *at++ = static_cast<std::byte>(n);
      put(value.data(), n * sizeof *value.data());
    } else {
      put(&value, sizeof value);
    }
  });
  return at - out;
}

bool unpackRecord(const std::byte* packed, std::size_t bytes, TickRecord& record) {
  record = TickRecord{};
  std::size_t at = 0;
  bool valid = true;
  const auto take = [&](void* to, std::size_t n) {
    valid = valid && n <= bytes - at;
    if (!valid) return;
    std::memcpy(to, packed + at, n);
    at += n;
  };
  visitFields(kRecordFields, [&](const auto& field) {
    auto&& value = field.of(record);
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (kIsItems<Value>) {
      valid = valid && value.count >= 0 && value.count <= value.capacity;
      if (valid) take(value.data, static_cast<std::size_t>(value.count) * sizeof *value.data);
    } else if constexpr (kIsTaggedArray<Value>) {
      std::byte size{};
      take(&size, sizeof size);
      const int n = std::to_integer<int>(size);
      valid = valid && n <= Value::capacity();
      if (!valid) return;
      value = Value(n);
      take(value.data(), static_cast<std::size_t>(n) * sizeof *value.data());
    } else {
      take(&value, sizeof value);
    }
  });
  return valid && at == bytes;
}

std::uint32_t recordLayout() noexcept {
  std::uint32_t crc = 0;
  const auto add = [&crc](const auto* from, std::size_t bytes) {
    crc = crc32(crc, reinterpret_cast<const std::byte*>(from), bytes);
  };
  visitFields(kRecordFields, [&](const auto& field) {
    using Of = std::remove_cvref_t<decltype(field.of)>;
    using Value = std::remove_cvref_t<std::invoke_result_t<Of, TickRecord&>>;
    std::array<std::size_t, 2> sizes{sizeof(Value), 1};
    if constexpr (kIsItems<Value>) {
      sizes = {sizeof(*std::declval<Value>().data),
               sizeof(field.of.array(std::declval<TickRecord&>()))};
    }
    add(field.name, std::strlen(field.name));
    add(sizes.data(), sizeof sizes);
  });
  return crc;
}

std::size_t packedBytes(int axes, int joints, int bodies, int values, int contacts) {
  const auto record = std::make_unique<TickRecord>();
  visitFields(kRecordFields, [&](const auto& field) {
    auto&& value = field.of(*record);
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (kIsTaggedArray<Value>) {
      const int size = field.labels == FieldLabels::kJoints ? joints : axes;
      value = Value(std::clamp(size, 0, Value::capacity()));
    }
  });
  record->body_count = bodies;
  record->exercise.value_count = values;
  record->contact_count = contacts;
  std::vector<std::byte> out(kMostPackedBytes);
  return packRecord(*record, out.data());
}

}  // namespace wholehand
