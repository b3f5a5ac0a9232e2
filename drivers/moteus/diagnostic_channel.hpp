#pragma once

#include "bus_clock.hpp"
#include "can_bus.hpp"

#include <optional>
#include <string>

namespace wholehand::moteus {

/// Sends a line on a drive's diagnostic channel and returns the answered line without its end;
/// empty when no line arrives within a second. Older text in the channel is dropped first. Source:
/// docs/protocol/diagnostic.md of mjbots/moteus, and its multiplex format (0x40 to 0x42). Waits;
/// not for the tick.
[[nodiscard]] std::optional<std::string> askDrive(CanBus& bus, BusClock& clock, int drive,
                                                  const std::string& question);

}  // namespace wholehand::moteus
