#pragma once

#include "schema_enums.hpp"

#include <array>
#include <cstdint>
#include <string>

namespace wholehand {

/// Faults of a tick, as bits OR-ed into its record; never exceptions. The bits in kStoppingFaults
/// start a ramp to the device's neutral effort in the same tick.
enum class Fault : std::uint32_t {
  kNone = 0,
  kDeviceRead = 1U << 0,         ///< the device delivered no position
  kDeviceWrite = 1U << 1,        ///< the device refused an effort
  kNonFinitePosition = 1U << 2,  ///< a device position is NaN or infinite
  kNonFiniteEffort = 1U << 3,    ///< a computed effort is NaN or infinite
  kNonFiniteState = 1U << 4,     ///< a joint or body of the physics world is NaN or infinite
  kPhysicsStep = 1U << 5,        ///< the physics engine could not step
  kEffortLimit = 1U << 6,        ///< information: an effort was clamped to the device's limit
  kLateTick = 1U << 7,           ///< information: one or more periods were skipped before this tick
  kContactsDropped = 1U << 8,    ///< information: more contacts than the record holds
  kSingularInertia = 1U << 9,    ///< the reduced inertia could not be inverted
  kStopRequested = 1U << 10,     ///< information: a person or the end of the run asked to stop
  kEmergencyStop = 1U << 11,     ///< information: a person pressed the emergency stop
  kSpeedLimit = 1U << 12,        ///< an axis moves faster than its limit
  kWorkspace = 1U << 13,         ///< an axis is beyond its range by more than its margin
  kPowerLimit = 1U << 14,        ///< information: efforts were scaled down to the device's power
  kEffortSlew = 1U << 15,        ///< information: an effort was limited by its slew limit
  kEncoderJump = 1U << 16,       ///< a position changed faster than any motion
  kEncoderStuck = 1U << 17,      ///< a position stands still although the effort should move it
  kLateInARow = 1U << 18,        ///< more late ticks in a row than the device allows
  kLongGap = 1U << 19,           ///< a gap between ticks longer than the device allows
  kHolderSilent = 1U << 20,      ///< information: the client that holds the controls is silent; the
                                 ///< exercise fades out
  kBodiesExploded = 1U << 21,  ///< the bodies gained energy in one step that nobody put in, or the
                               ///< simulated hand is implausibly fast
  kTankEmpty = 1U << 22,       ///< information: an empty energy tank added damping
  kDriveFault = 1U << 23,      ///< a drive of the device reports a fault
  kEnableLost = 1U << 24,      ///< efforts no longer reach the motors: emergency stop or watchdog
  /// A sample of the device is too old, stands still or goes back in time.
  kStaleSample = 1U << 25,
  kDriveHot = 1U << 26,      ///< information: a drive is near its temperature limit
  kGentleStop = 1U << 27,    ///< information: the requested stop is a gentle one
  kSampleDelay = 1U << 28,   ///< the device's samples come later than the certificate assumes
  kEffortAstray = 1U << 29,  ///< a drive measures an effort that differs from the one that was sent
  /// The world gave energy that nobody put in, although the energy tank damped.
  kWorldGivesEnergy = 1U << 30,
  kContactsUnsettled = 1U << 31,  ///< information: contact forces were still changing when the step
                                  ///< had to end
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

/// Number of the bits above.
inline constexpr int kFaultBits = 32;

/// Effect of a fault on the run.
enum class FaultReaction {
  kStops,     ///< the ramp to neutral begins
  kCounted,   ///< rendering goes on; the fault is counted and listed in the summary
  kRecorded,  ///< a request, or a client that is gone; only recorded
};

/// Name and reaction of one bit. Records, summaries, metrics and the safety page use this table.
struct FaultFacts {
  Fault bit;
  const char* name;  ///< shown to people, e.g. "device read failed"
  FaultReaction reaction;
};

/// The table of all faults, in the order of their bits.
inline constexpr std::array<FaultFacts, kFaultBits> kFaultTable{{
    {Fault::kDeviceRead, "device read failed", FaultReaction::kStops},
    {Fault::kDeviceWrite, "device write failed", FaultReaction::kStops},
    {Fault::kNonFinitePosition, "non-finite device position", FaultReaction::kStops},
    {Fault::kNonFiniteEffort, "non-finite effort", FaultReaction::kStops},
    {Fault::kNonFiniteState, "non-finite state", FaultReaction::kStops},
    {Fault::kPhysicsStep, "physics step failed", FaultReaction::kStops},
    {Fault::kEffortLimit, "effort limited", FaultReaction::kCounted},
    {Fault::kLateTick, "late tick", FaultReaction::kCounted},
    {Fault::kContactsDropped, "contacts dropped", FaultReaction::kCounted},
    {Fault::kSingularInertia, "singular reduced inertia", FaultReaction::kStops},
    {Fault::kStopRequested, "stop requested", FaultReaction::kRecorded},
    {Fault::kEmergencyStop, "emergency stop", FaultReaction::kRecorded},
    {Fault::kSpeedLimit, "speed limit exceeded", FaultReaction::kStops},
    {Fault::kWorkspace, "workspace left", FaultReaction::kStops},
    {Fault::kPowerLimit, "power limited", FaultReaction::kCounted},
    {Fault::kEffortSlew, "effort slew limited", FaultReaction::kCounted},
    {Fault::kEncoderJump, "encoder jumped", FaultReaction::kStops},
    {Fault::kEncoderStuck, "encoder stuck", FaultReaction::kStops},
    {Fault::kLateInARow, "late ticks in a row", FaultReaction::kStops},
    {Fault::kLongGap, "gap too long", FaultReaction::kStops},
    {Fault::kHolderSilent, "owner silent", FaultReaction::kRecorded},
    {Fault::kBodiesExploded, "bodies exploded", FaultReaction::kStops},
    {Fault::kTankEmpty, "tank damped", FaultReaction::kCounted},
    {Fault::kDriveFault, "drive fault", FaultReaction::kStops},
    {Fault::kEnableLost, "enable lost", FaultReaction::kStops},
    {Fault::kStaleSample, "stale sample", FaultReaction::kStops},
    {Fault::kDriveHot, "drive hot", FaultReaction::kCounted},
    {Fault::kGentleStop, "gentle stop", FaultReaction::kRecorded},
    {Fault::kSampleDelay, "samples delayed", FaultReaction::kStops},
    {Fault::kEffortAstray, "effort astray", FaultReaction::kStops},
    {Fault::kWorldGivesEnergy, "world gives energy", FaultReaction::kStops},
    {Fault::kContactsUnsettled, "contacts unsettled", FaultReaction::kCounted},
}};

/// All bits with one reaction.
[[nodiscard]] constexpr Fault faultsWith(FaultReaction reaction) noexcept {
  Fault bits = Fault::kNone;
  for (const FaultFacts& fault : kFaultTable) {
    if (fault.reaction == reaction) bits |= fault.bit;
  }
  return bits;
}

/// The faults that HapticDevice::read() may return.
inline constexpr Fault kOfReading = Fault::kDeviceRead | Fault::kDriveFault | Fault::kEnableLost |
                                    Fault::kStaleSample | Fault::kDriveHot | Fault::kSampleDelay |
                                    Fault::kEffortAstray;

/// The faults that stop rendering; the others are counted and shown.
inline constexpr Fault kStoppingFaults = faultsWith(FaultReaction::kStops);

/// Name of one bit (0 .. kFaultBits - 1) for people, e.g. "device read failed".
[[nodiscard]] const char* faultName(int bit) noexcept;

/// Names of all set bits, "late tick, effort limited"; empty when none is set.
[[nodiscard]] std::string faultNames(Fault faults);

}  // namespace wholehand
