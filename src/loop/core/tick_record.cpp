#include "loop/core/tick_record.hpp"

#include <array>
#include <cstddef>

namespace wholehand {

const char* stageName(Stage s) noexcept {
  static constexpr std::array<const char*, kStages> kNames = {
      "device_read", "observe",      "dynamics",     "control", "exercise",
      "safety",      "device_write", "physics_step", "contacts"};
  static_assert(kNames.back() != nullptr, "a name for each stage");
  const auto i = static_cast<std::size_t>(s);
  return i < kNames.size() ? kNames[i] : "unknown";
}

}  // namespace wholehand
