#pragma once

#include "devices/plugin/plugin_driver.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace wholehand {

/// Options of `wholehand device-host`.
struct DeviceHostOptions {
  std::string name;       ///< name for `run --host`
  std::string device;     ///< device file
  DriverLocation driver;  ///< calls may block
  double rate_hz = 4000.0;
};

/// Holds a device for the loop of another process until a signal. Returns the exit code.
int deviceHostCommand(const DeviceHostOptions& options);

/// Adds `wholehand device-host`. @pre options outlive the parsing
void addDeviceHost(CLI::App& app, DeviceHostOptions& options, int& code);

}  // namespace wholehand
