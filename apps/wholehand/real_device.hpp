#pragma once

#include "device/plugin/device_driver.hpp"
#include "run_options.hpp"
#include "station/station.hpp"
#include "status_line.hpp"

#include <memory>

namespace wholehand {

/// Where the options name a driver or a host: loads it, asks for its passport, and lets the station
/// take its device at every arming. A person holds it, so a person asks for the first force:
/// options.wait becomes true. Null where they name none.
[[nodiscard]] Expected<std::shared_ptr<DeviceDriver>> useDriver(RunOptions& options,
                                                                StationConfig& config,
                                                                Terminal& terminal);

/// Loudly, where nothing of the device was measured.
void warnOfNoPassport(Terminal& terminal);

}  // namespace wholehand
