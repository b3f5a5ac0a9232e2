#include "core/fault.hpp"

#include <array>

namespace wholehand {

const char* faultName(int bit) noexcept {
  static constexpr std::array<const char*, kFaultBits> kNames = {
      "device read failed",       "device write failed", "non-finite device position",
      "non-finite effort",        "non-finite state",    "physics step failed",
      "effort limited",           "late tick",           "contacts dropped",
      "singular reduced inertia", "stop requested",      "emergency stop",
      "speed limit exceeded",     "workspace left",      "power limited",
      "effort slew limited",      "encoder jumped",      "encoder stuck",
      "late ticks in a row",      "gap too long",        "owner silent",
      "bodies exploded",          "tank damped"};
  return bit >= 0 && bit < kFaultBits ? kNames[static_cast<std::size_t>(bit)] : "unknown";
}

}  // namespace wholehand
