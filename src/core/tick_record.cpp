#include "core/tick_record.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace wholehand {

const char* stageName(Stage s) noexcept {
  static constexpr std::array<const char*, kStages> kNames = {
      "device_read", "observe",      "dynamics",     "control", "exercise",
      "safety",      "device_write", "physics_step", "contacts"};
  static_assert(kNames.back() != nullptr, "a name for each stage");
  const auto i = static_cast<std::size_t>(s);
  return i < kNames.size() ? kNames[i] : "unknown";
}

void copyUsed(const TickRecord& from, TickRecord& to) noexcept {
  const auto copy = [&](std::size_t begin, std::size_t end) noexcept {
    std::memcpy(reinterpret_cast<std::byte*>(&to) + begin,
                reinterpret_cast<const std::byte*>(&from) + begin, end - begin);
  };
  const auto items = [](std::int32_t count, int most, std::size_t item_bytes) noexcept {
    return std::clamp(count, 0, most) * item_bytes;
  };
  constexpr std::size_t kBodies = offsetof(TickRecord, bodies);
  constexpr std::size_t kContacts = offsetof(TickRecord, contacts);
  copy(0, kBodies + items(from.body_count, kMaxBodies, sizeof(BodyState)));
  copy(kBodies + sizeof from.bodies,
       kContacts + items(from.contact_count, kMaxContacts, sizeof(Contact)));
}

}  // namespace wholehand
