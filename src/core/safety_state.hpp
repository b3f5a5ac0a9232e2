#pragma once

#include <cstdint>

namespace wholehand {

/// State of the safety supervisor (docs/safety.md), in every record. A transition is a change from
/// one record to the next; its cause are the faults of that record.
///
///   Disarmed → Armed       a person arms and the checks of arm() pass
///   Armed → Rendering      the effort is fully blended in
///   Armed, Rendering → Disarmed   a stop was requested and the device is at its neutral effort
///   Armed, Rendering → Faulted    a fault of kStopping; the ramp to neutral begins in that tick
///   Faulted → Armed        a person arms again
enum class SafetyState : std::int32_t { kDisarmed, kArmed, kRendering, kFaulted };

/// "disarmed", "armed", "rendering" or "faulted"; "unknown" for any other number. Real-time safe.
[[nodiscard]] constexpr const char* safetyStateName(SafetyState state) noexcept {
  switch (state) {
    case SafetyState::kDisarmed:
      return "disarmed";
    case SafetyState::kArmed:
      return "armed";
    case SafetyState::kRendering:
      return "rendering";
    case SafetyState::kFaulted:
      return "faulted";
  }
  return "unknown";
}

}  // namespace wholehand
