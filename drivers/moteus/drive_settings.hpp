#pragma once

#include "bus_clock.hpp"
#include "can_bus.hpp"
#include "loop/core/expected.hpp"
#include "motor_map.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace wholehand::moteus {

/// Longest accepted `servo.default_timeout_s`: the factory setting [s].
inline constexpr double kLongestTimeout_s = 0.1;

/// Reads those settings of a drive that decide what it does when no command arrives, or that add to
/// its commanded torque. Returns the unsafe ones and how to set them:
///
/// | setting | accepted | because |
/// |---|---|---|
/// | servo.default_timeout_s | 0 to 0.1 s, not nan | a command without a watchdog would hold |
/// | servo.timeout_mode | 0 stopped, 12 zero velocity | 10 holds with up to its greatest current,
///   15 brakes as hard as the motor can |
/// | servo.timeout_max_torque_Nm | up to max_torque_nm of the motor | the factory's 5 N.m are more
///   than a finger bears |
/// | servo.fixed_voltage_mode | 0 | torque is ignored in this mode |
/// | servo.inertia_feedforward | 0 | it adds to the torque |
///
/// Empty: all settings are safe. Waits; not for the tick.
[[nodiscard]] Diagnostics checkDrive(CanBus& bus, BusClock& clock, const Motor& motor);

struct DriveIdentity {
  std::array<std::uint32_t, 3> serial{};
  std::uint32_t firmware = 0;
};
/// Identity of a drive; empty when it does not answer within 200 ms. Waits; not for the tick.
[[nodiscard]] std::optional<DriveIdentity> identifyDrive(CanBus& bus, BusClock& clock, int drive);

}  // namespace wholehand::moteus
