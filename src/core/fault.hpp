#pragma once

#include <cstdint>

namespace wholehand {

/// What went wrong in a tick, as bits OR-ed into its record. A fault is never an exception; the
/// ones in kStopping start a ramp to the device's neutral effort in the same tick.
enum class Fault : std::uint32_t {
  kNone = 0,
  kDeviceRead = 1U << 0,         ///< the device gave no position
  kDeviceWrite = 1U << 1,        ///< the device refused an effort
  kNonFinitePosition = 1U << 2,  ///< a device position is NaN or infinite
  kNonFiniteEffort = 1U << 3,    ///< a computed effort is NaN or infinite
  kNonFiniteState = 1U << 4,     ///< a joint or body of the physics world is NaN or infinite
  kPhysicsStep = 1U << 5,        ///< the physics engine could not step
  kEffortLimit = 1U << 6,        ///< information: an effort was clamped to the device's limit
  kLateTick = 1U << 7,           ///< information: one or more periods were skipped before this tick
  kContactsDropped = 1U << 8,    ///< information: more contacts than the record can hold
  kSingularInertia = 1U << 9,    ///< the reduced inertia could not be inverted
  kStopRequested = 1U << 10,     ///< information: a person or the end of the run asked to stop
};

[[nodiscard]] constexpr Fault operator|(Fault a, Fault b) noexcept {
  return static_cast<Fault>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
[[nodiscard]] constexpr Fault operator&(Fault a, Fault b) noexcept {
  return static_cast<Fault>(static_cast<std::uint32_t>(a) & static_cast<std::uint32_t>(b));
}
constexpr Fault& operator|=(Fault& a, Fault b) noexcept {
  return a = a | b;
}
[[nodiscard]] constexpr bool any(Fault f) noexcept {
  return f != Fault::kNone;
}

/// The faults that stop rendering; the others are counted and shown.
inline constexpr Fault kStopping =
    Fault::kDeviceRead | Fault::kDeviceWrite | Fault::kNonFinitePosition | Fault::kNonFiniteEffort |
    Fault::kNonFiniteState | Fault::kPhysicsStep | Fault::kSingularInertia;

/// The number of distinct bits above, for counters.
inline constexpr int kFaultBits = 11;

/// A person's name for one bit (0 .. kFaultBits - 1), e.g. "device read failed".
[[nodiscard]] const char* faultName(int bit) noexcept;

}  // namespace wholehand
