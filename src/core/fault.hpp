#pragma once

#include <array>
#include <cstdint>
#include <string>

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
  kEmergencyStop = 1U << 11,     ///< information: a person pressed the emergency stop
  kSpeedLimit = 1U << 12,        ///< an axis moves faster than its limit
  kWorkspace = 1U << 13,         ///< an axis is beyond its range by more than its margin
  kPowerLimit = 1U << 14,        ///< information: efforts were scaled down to the device's power
  kEffortSlew = 1U << 15,        ///< information: an effort was held back to its slew limit
  kEncoderJump = 1U << 16,       ///< a position changed by more than any motion could
  kEncoderStuck = 1U << 17,      ///< a position stands still that the effort should move
  kLateInARow = 1U << 18,        ///< more late ticks in a row than the device allows
  kLongGap = 1U << 19,           ///< a gap between ticks longer than the device allows
  kOwnerSilent = 1U << 20,       ///< information: who shows the exercise is silent; it fades out
  kBodiesExploded =
      1U << 21,            ///< a body of the world changed its speed as none could, or the hand did
  kTankEmpty = 1U << 22,   ///< information: the energy tank damped
  kDriveFault = 1U << 23,  ///< a drive of the device has stopped itself
  kEnableLost = 1U << 24,  ///< efforts no longer reach the motors: a stop button, a watchdog
  kStaleSample = 1U << 25,  ///< the device's samples stand still or run backwards
  kDriveHot = 1U << 26,     ///< information: a drive is near its temperature limit
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

/// The number of distinct bits above, for counters.
inline constexpr int kFaultBits = 27;

/// What a fault does to the run.
enum class FaultReaction {
  kStops,   ///< the ramp to neutral begins
  kGoesOn,  ///< something was held back or went wrong: counted and told in the summary
  kIsSaid,  ///< somebody asked, or has left: in the record
};

/// What is to be known of one bit. Records, summaries, metrics and the safety page take it from
/// here.
struct FaultFacts {
  Fault bit;
  const char* name;  ///< for a person, e.g. "device read failed"
  FaultReaction reaction;
};

/// In the order of the bits.
inline constexpr std::array<FaultFacts, kFaultBits> kFaultTable{{
    {Fault::kDeviceRead, "device read failed", FaultReaction::kStops},
    {Fault::kDeviceWrite, "device write failed", FaultReaction::kStops},
    {Fault::kNonFinitePosition, "non-finite device position", FaultReaction::kStops},
    {Fault::kNonFiniteEffort, "non-finite effort", FaultReaction::kStops},
    {Fault::kNonFiniteState, "non-finite state", FaultReaction::kStops},
    {Fault::kPhysicsStep, "physics step failed", FaultReaction::kStops},
    {Fault::kEffortLimit, "effort limited", FaultReaction::kGoesOn},
    {Fault::kLateTick, "late tick", FaultReaction::kGoesOn},
    {Fault::kContactsDropped, "contacts dropped", FaultReaction::kGoesOn},
    {Fault::kSingularInertia, "singular reduced inertia", FaultReaction::kStops},
    {Fault::kStopRequested, "stop requested", FaultReaction::kIsSaid},
    {Fault::kEmergencyStop, "emergency stop", FaultReaction::kIsSaid},
    {Fault::kSpeedLimit, "speed limit exceeded", FaultReaction::kStops},
    {Fault::kWorkspace, "workspace left", FaultReaction::kStops},
    {Fault::kPowerLimit, "power limited", FaultReaction::kGoesOn},
    {Fault::kEffortSlew, "effort slew limited", FaultReaction::kGoesOn},
    {Fault::kEncoderJump, "encoder jumped", FaultReaction::kStops},
    {Fault::kEncoderStuck, "encoder stuck", FaultReaction::kStops},
    {Fault::kLateInARow, "late ticks in a row", FaultReaction::kStops},
    {Fault::kLongGap, "gap too long", FaultReaction::kStops},
    {Fault::kOwnerSilent, "owner silent", FaultReaction::kIsSaid},
    {Fault::kBodiesExploded, "bodies exploded", FaultReaction::kStops},
    {Fault::kTankEmpty, "tank damped", FaultReaction::kGoesOn},
    {Fault::kDriveFault, "drive fault", FaultReaction::kStops},
    {Fault::kEnableLost, "enable lost", FaultReaction::kStops},
    {Fault::kStaleSample, "stale sample", FaultReaction::kStops},
    {Fault::kDriveHot, "drive hot", FaultReaction::kGoesOn},
}};

/// All bits of one reaction.
[[nodiscard]] constexpr Fault faultsThat(FaultReaction reaction) noexcept {
  Fault bits = Fault::kNone;
  for (const FaultFacts& fault : kFaultTable) {
    if (fault.reaction == reaction) bits |= fault.bit;
  }
  return bits;
}

/// The faults that stop rendering; the others are counted and shown.
inline constexpr Fault kStopping = faultsThat(FaultReaction::kStops);

/// A person's name for one bit (0 .. kFaultBits - 1), e.g. "device read failed".
[[nodiscard]] const char* faultName(int bit) noexcept;

/// The names of all bits that are set: "late tick, effort limited"; empty: none.
[[nodiscard]] std::string faultNames(Fault faults);

}  // namespace wholehand
