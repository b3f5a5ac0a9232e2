#pragma once

#include "device/plugin/plugin_driver.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace wholehand {

/// What `wholehand device-host` was asked for.
struct DeviceHostOptions {
  std::string name;       ///< by which `run --host` finds it
  std::string device;     ///< device file
  DriverLocation driver;  ///< may wait
  double rate_hz = 4000.0;
};

/// Holds a device for the loop of another process, until a signal. Returns the program's exit code.
int deviceHostCommand(const DeviceHostOptions& options);

/// Adds `wholehand device-host`. @pre options outlive the parsing
void addDeviceHost(CLI::App& app, DeviceHostOptions& options, int& code);

}  // namespace wholehand
