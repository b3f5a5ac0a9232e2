#pragma once

#include "device/plugin/device_driver.hpp"
#include "run_options.hpp"
#include "station/station.hpp"
#include "status_line.hpp"

#include <memory>

namespace wholehand {

/// Loads the driver or host that the options name, reads its passport, and makes the station open
/// its device at every arming. Since a person holds the device, a person must ask for the first
/// force: options.wait becomes true. Null when the options name none.
[[nodiscard]] Expected<std::shared_ptr<DeviceDriver>> useDriver(RunOptions& options,
                                                                StationConfig& config,
                                                                Terminal& terminal);

/// Prints a prominent warning: the device was not measured.
void warnOfNoPassport(Terminal& terminal);

}  // namespace wholehand
