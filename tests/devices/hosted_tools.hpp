#pragma once

#include "devices/host/hosted_driver.hpp"
#include "devices/plugin/plugin_device.hpp"
#include "devices/plugin/plugin_driver.hpp"
#include "files/device/device_file.hpp"
#include "host_tools.hpp"

/// The desktop device behind the faulty driver and a host.
namespace wholehand::test {

inline std::string built(const std::string& name) {
  return std::string(WHOLEHAND_BINARY_DIR) + "/drivers/" + name + ".so";
}

inline std::string deviceFile() {
  return std::string(WHOLEHAND_SOURCE_DIR) + "/config/devices/desktop-3axis.toml";
}

/// The desktop device with an output delay of two periods: the driver's 1 ms and two cycles of the
/// host.
inline DeviceModel desktop() {
  DeviceModel model = orThrow(loadDeviceFile(deviceFile()));
  model.output_delay_ticks = 2;
  return model;
}

inline std::shared_ptr<DeviceDriver> faultyDriver(const std::string& settings,
                                                  const std::string& name = "faulty") {
  return orThrow(PluginDriver::load({built(name), "", settings}, nullptr, CalledBy::kHost));
}

inline std::unique_ptr<HapticDevice> deviceOf(const std::shared_ptr<HostedDriver>& driver) {
  return orThrow(PluginDevice::make(driver, desktop(), 1e-3));
}

inline AxisEffort efforts(double x, double y, double z) {
  AxisEffort effort(3);
  effort[0] = x, effort[1] = y, effort[2] = z;
  return effort;
}

inline void sleepMs(int ms) {
  std::this_thread::sleep_for(std::chrono::milliseconds(ms));
}

}  // namespace wholehand::test
