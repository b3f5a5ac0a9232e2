#include "core/tick_record.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace wholehand {

const char* stageName(Stage s) noexcept {
  switch (s) {
    case Stage::kDeviceRead:
      return "device_read";
    case Stage::kObserve:
      return "observe";
    case Stage::kDynamics:
      return "dynamics";
    case Stage::kControl:
      return "control";
    case Stage::kExercise:
      return "exercise";
    case Stage::kSafety:
      return "safety";
    case Stage::kDeviceWrite:
      return "device_write";
    case Stage::kPhysicsStep:
      return "physics_step";
    case Stage::kContacts:
      return "contacts";
    case Stage::kCount:
      break;
  }
  return "unknown";
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
