#pragma once

#include "commission_command.hpp"
#include "device/conformance/conformance.hpp"
#include "device/plugin/plugin_driver.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace wholehand {

/// What `wholehand device` was asked for.
struct DeviceOptions {
  DriverLocation driver;
  std::string device;  ///< device file to hold the driver against; empty: none
  std::string json;
  ConformanceOptions conformance;
  CommissionOptions commission;
};

/// Drivers beside the program and hosts of this machine; opens no device. Returns the exit code.
int deviceListCommand(const DeviceOptions& options);
/// Axes and one sample of a device, which stays disabled.
int deviceInspectCommand(const DeviceOptions& options);
/// The conformance suite; kExitNotFit where a check fails.
int deviceConformCommand(const DeviceOptions& options);

/// Writes JSON where `path` is not empty. Returns the exit code.
int keepJson(const std::string& path, const std::string& text);

/// Adds `wholehand device list | inspect | conform | commission`. @pre options outlive the parsing
void addDevice(CLI::App& app, DeviceOptions& options, int& code);

}  // namespace wholehand
