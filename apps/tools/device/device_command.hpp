#pragma once

#include "apps/tools/device/commission_command.hpp"
#include "devices/conformance/conformance.hpp"
#include "devices/plugin/plugin_driver.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include <string>

namespace wholehand {

/// Options of `wholehand device`.
struct DeviceOptions {
  DriverLocation driver;
  std::string device;  ///< device file to check the driver against; empty: none
  std::string json;
  ConformanceOptions conformance;
  CommissionOptions commission;
};

/// Lists the drivers in the program's folders and the hosts of this machine; opens no device.
/// Returns the exit code.
int deviceListCommand(const DeviceOptions& options);
/// Prints the axes and one sample of a device, which stays disabled.
int deviceInspectCommand(const DeviceOptions& options);
/// Runs the conformance suite; kExitNotFit when a check fails.
int deviceConformCommand(const DeviceOptions& options);

/// Writes JSON if `path` is not empty. Returns the exit code.
int writeJson(const std::string& path, const nlohmann::ordered_json& json);

/// Adds `wholehand device list | inspect | conform | commission`. @pre options outlive the parsing
void addDevice(CLI::App& app, DeviceOptions& options, int& code);

}  // namespace wholehand
