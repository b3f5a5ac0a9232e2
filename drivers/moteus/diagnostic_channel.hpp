#pragma once

#include "bus_clock.hpp"
#include "can_bus.hpp"

#include <optional>
#include <string>

namespace wholehand::moteus {

/// Asks a drive one line on its diagnostic channel and returns the line that it answers, without
/// its end; nothing where none comes within a second. What the channel still held is dropped first.
/// Source: docs/protocol/diagnostic.md of mjbots/moteus, and its multiplex format (0x40 to 0x42).
/// Waits; not for the tick.
[[nodiscard]] std::optional<std::string> askDrive(CanBus& bus, BusClock& clock, int drive,
                                                  const std::string& question);

}  // namespace wholehand::moteus
