#pragma once

#include "core/expected.hpp"
#include "core/real_time.hpp"
#include "wholehand/device.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Where a driver is and what it is told.
struct DriverLocation {
  std::string path;      ///< of the shared object
  std::string locator;   ///< which device: a port, a serial number; the driver's own words
  std::string settings;  ///< the driver's own words
};

/// A driver that was loaded from a shared object (include/wholehand/device.h), with its device open
/// but not enabled. It stays so from one arming to the next: a device is found and homed once.
class PluginDriver {
 public:
  /// Loads the driver, opens its device and asks for its axes. Refused, each by name: no such file,
  /// no `wh_plugin_v1`, another major version, a structure that ends before a function, a driver
  /// that may wait, a device that is not found.
  /// @param say takes the driver's lines; may be null
  [[nodiscard]] static Expected<std::shared_ptr<PluginDriver>> load(
      const DriverLocation& location, std::function<void(const std::string&)> say = nullptr);
  /// Closes the device. The code stays loaded: a driver's own threads may still be in it.
  ~PluginDriver();
  PluginDriver(const PluginDriver&) = delete;
  PluginDriver& operator=(const PluginDriver&) = delete;

  [[nodiscard]] const DriverLocation& location() const noexcept { return location_; }
  [[nodiscard]] const char* name() const noexcept;
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept { return axes_; }

  /// One of the verbs of device.h. Not real-time safe.
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument = 0.0);
  /// As the driver's read and write.
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept;
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept;

 private:
  PluginDriver(DriverLocation location, std::function<void(const std::string&)> say);
  [[nodiscard]] Expected<Done> open();
  [[nodiscard]] Expected<Done> describe();
  [[nodiscard]] Diagnostic failed(const std::string& what, const std::string& remedy) const;
  static void take(void* self, const char* line);

  DriverLocation location_;
  std::function<void(const std::string&)> say_;
  std::string last_line_;  ///< that the driver said
  wh_host host_{};
  const wh_plugin* plugin_ = nullptr;
  wh_device* device_ = nullptr;
  std::vector<wh_axis> axes_;
};

}  // namespace wholehand
