#include "loop/core/record_packing.hpp"

#include "loop/core/crc32.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace wholehand {
namespace {

/// A part of a record. kBytes: kept whole. kArray: an axis or joint array, kept up to its size.
/// kItems: as many items are kept as a count earlier in the record says.
struct Piece {
  enum class Kind : std::uint8_t { kBytes, kArray, kItems };
  Kind kind;
  std::uint32_t offset;
  std::uint32_t item_bytes;    ///< size of one item; kBytes: of the whole part
  std::uint32_t capacity;      ///< largest number of items
  std::uint32_t count_offset;  ///< kItems: offset of the count, an int32

  [[nodiscard]] constexpr std::uint32_t end() const {
    const std::uint32_t size = kind == Kind::kArray ? sizeof(std::int64_t) : 0;
    return offset + capacity * item_bytes + size;
  }
};

constexpr Piece bytesBetween(std::size_t first, std::size_t end) {
  return {Piece::Kind::kBytes, static_cast<std::uint32_t>(first),
          static_cast<std::uint32_t>(end - first), 1, 0};
}
constexpr Piece arrayAt(std::size_t offset, int capacity, std::size_t item_bytes = sizeof(double)) {
  return {Piece::Kind::kArray, static_cast<std::uint32_t>(offset),
          static_cast<std::uint32_t>(item_bytes), static_cast<std::uint32_t>(capacity), 0};
}
constexpr Piece itemsAt(std::size_t offset, std::size_t item_bytes, int capacity,
                        std::size_t count_offset) {
  return {Piece::Kind::kItems, static_cast<std::uint32_t>(offset),
          static_cast<std::uint32_t>(item_bytes), static_cast<std::uint32_t>(capacity),
          static_cast<std::uint32_t>(count_offset)};
}

using R = TickRecord;
constexpr std::size_t kExercise = offsetof(R, exercise);
constexpr std::size_t kPlacements = offsetof(R, placements);

constexpr std::array kPieces{
    bytesBetween(offsetof(R, tick), offsetof(R, help) + sizeof(R::help)),
    bytesBetween(offsetof(R, command_count), offsetof(R, fault_axis) + sizeof(R::fault_axis)),
    itemsAt(offsetof(R, commands), sizeof(Command), kMaxCommands, offsetof(R, command_count)),
    itemsAt(offsetof(R, parameters), sizeof(double), kMaxLiveParameters,
            offsetof(R, parameter_count)),
    arrayAt(offsetof(R, q_m), kMaxAxes),
    arrayAt(offsetof(R, intention), kMaxAxes),
    arrayAt(offsetof(R, patient_effort), kMaxAxes),
    arrayAt(offsetof(R, qd_mf), kMaxAxes),
    arrayAt(offsetof(R, q_s), kMaxAxes),
    arrayAt(offsetof(R, qd_s), kMaxAxes),
    arrayAt(offsetof(R, theta), kMaxJoints),
    bytesBetween(offsetof(R, coupling_error_rad),
                 offsetof(R, palm_target_distance_m) + sizeof(R::palm_target_distance_m)),
    arrayAt(offsetof(R, closure), kMaxAxes),
    bytesBetween(offsetof(R, body_count), offsetof(R, palm_body) + sizeof(R::palm_body)),
    itemsAt(offsetof(R, bodies), sizeof(BodyState), kMaxBodies, offsetof(R, body_count)),
    arrayAt(offsetof(R, f_s), kMaxAxes),
    arrayAt(offsetof(R, coupling), kMaxAxes),
    arrayAt(kExercise + offsetof(ExerciseRecord, effort), kMaxAxes),
    bytesBetween(kExercise + offsetof(ExerciseRecord, alpha),
                 kExercise + offsetof(ExerciseRecord, alpha) + sizeof(double)),
    arrayAt(kExercise + offsetof(ExerciseRecord, wall_active), kMaxAxes, sizeof(AxisFlag::Value)),
    arrayAt(kExercise + offsetof(ExerciseRecord, wall), kMaxAxes),
    bytesBetween(kExercise + offsetof(ExerciseRecord, value_count),
                 kExercise + offsetof(ExerciseRecord, event_count) + sizeof(std::int32_t)),
    itemsAt(kExercise + offsetof(ExerciseRecord, values), sizeof(double), kMaxExerciseValues,
            kExercise + offsetof(ExerciseRecord, value_count)),
    itemsAt(kExercise + offsetof(ExerciseRecord, events), sizeof(ExerciseEvent), kMaxExerciseEvents,
            kExercise + offsetof(ExerciseRecord, event_count)),
    bytesBetween(kPlacements, kPlacements + offsetof(BodyPlacements, items)),
    itemsAt(kPlacements + offsetof(BodyPlacements, items), sizeof(BodyPlacement), kMaxPlacements,
            kPlacements + offsetof(BodyPlacements, count)),
    arrayAt(offsetof(R, phi), kMaxAxes),
    arrayAt(offsetof(R, damping), kMaxAxes),
    arrayAt(offsetof(R, tank), kMaxAxes),
    arrayAt(offsetof(R, tank_effort), kMaxAxes),
    arrayAt(offsetof(R, rendered), kMaxAxes),
    bytesBetween(offsetof(R, authority), offsetof(R, authority) + sizeof(R::authority)),
    arrayAt(offsetof(R, sent), kMaxAxes),
    arrayAt(offsetof(R, effort_limit), kMaxAxes),
    bytesBetween(offsetof(R, contact_count),
                 offsetof(R, contacts_dropped) + sizeof(R::contacts_dropped)),
    itemsAt(offsetof(R, contacts), sizeof(Contact), kMaxContacts, offsetof(R, contact_count)),
};

/// True when the pieces cover every field: they are contiguous except for padding smaller than a
/// double.
constexpr bool covered() {
  std::uint32_t end = 0;
  for (const Piece& p : kPieces) {
    if (p.offset < end || p.offset - end >= sizeof(double)) return false;
    end = p.end();
  }
  return end <= sizeof(R) && sizeof(R) - end < sizeof(double);
}
static_assert(covered(), "a field of TickRecord is missing in kPieces");
static_assert(sizeof(AxisPosition) == kMaxAxes * sizeof(double) + sizeof(std::int64_t));
static_assert(sizeof(AxisFlag) == kMaxAxes * sizeof(AxisFlag::Value) + sizeof(std::int64_t));
static_assert(kMaxJoints <= 255, "a size is kept in one byte");

std::int64_t sizeOf(const Piece& p, const std::byte* record) noexcept {
  if (p.kind == Piece::Kind::kBytes) return 1;
  if (p.kind == Piece::Kind::kItems) {
    std::int32_t count = 0;
    std::memcpy(&count, record + p.count_offset, sizeof count);
    return count;
  }
  std::int64_t size = 0;
  std::memcpy(&size, record + p.offset + p.capacity * p.item_bytes, sizeof size);
  return size;
}

}  // namespace

std::size_t packRecord(const TickRecord& record, std::byte* out) noexcept {
  const auto* from = reinterpret_cast<const std::byte*>(&record);
  std::byte* at = out;
  for (const Piece& p : kPieces) {
    const std::size_t n = std::clamp<std::int64_t>(sizeOf(p, from), 0, p.capacity);
    if (p.kind == Piece::Kind::kArray) *at++ = static_cast<std::byte>(n);
    const std::size_t bytes = n * p.item_bytes;
    std::memcpy(at, from + p.offset, bytes);
    at += bytes;
  }
  return at - out;
}

bool unpackRecord(const std::byte* packed, std::size_t bytes, TickRecord& record) {
  record = TickRecord{};
  auto* to = reinterpret_cast<std::byte*>(&record);
  std::size_t at = 0;
  for (const Piece& p : kPieces) {
    std::int64_t n = sizeOf(p, to);
    if (p.kind == Piece::Kind::kArray) {
      if (at == bytes) return false;
      n = std::to_integer<std::int64_t>(packed[at++]);
      std::memcpy(to + p.offset + p.capacity * p.item_bytes, &n, sizeof n);
    }
    if (n < 0 || n > p.capacity) return false;
    const std::size_t length = n * p.item_bytes;
    if (length > bytes - at) return false;
    std::memcpy(to + p.offset, packed + at, length);
    at += length;
  }
  return at == bytes;
}

std::uint32_t recordLayout() noexcept {
  std::uint32_t crc = 0;
  for (const Piece& p : kPieces) {
    const std::array<std::uint32_t, 5> numbers{static_cast<std::uint32_t>(p.kind), p.offset,
                                               p.item_bytes, p.capacity, p.count_offset};
    crc = crc32(crc, reinterpret_cast<const std::byte*>(numbers.data()), sizeof numbers);
  }
  return crc;
}

std::size_t packedBytes(int axes, int joints, int bodies, int values, int contacts) noexcept {
  std::size_t bytes = 0;
  const auto of = [](int n) -> std::size_t { return std::max(n, 0); };
  for (const Piece& p : kPieces) {
    if (p.kind == Piece::Kind::kBytes) bytes += p.item_bytes;
    if (p.kind != Piece::Kind::kArray) continue;
    bytes += 1 + of(p.capacity == kMaxJoints ? joints : axes) * p.item_bytes;
  }
  return bytes + of(bodies) * sizeof(BodyState) + of(values) * sizeof(double) +
         of(contacts) * sizeof(Contact);
}

}  // namespace wholehand
