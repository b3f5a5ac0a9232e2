#pragma once

#include "devices/plugin/device_driver.hpp"
#include "loop/core/expected.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// Folders of the drivers shipped with this program: `drivers` in the program's folder (build
/// tree), and `../lib/wholehand/drivers` (installation).
[[nodiscard]] std::vector<std::string> shippedDriverFolders();

/// Path of a driver. A name with a slash or the ending .so is a path; without a slash it is
/// relative to the working directory. Any other name is looked up in the folders in order. Refused:
/// a name in none of them; the error lists the available ones.
[[nodiscard]] Expected<std::string> findDriver(const std::string& name,
                                               const std::vector<std::string>& folders);

/// Reason why the last dlopen() of `path` failed, without the path, which dlerror() puts first.
[[nodiscard]] std::string loaderProblem(const std::string& path);

/// Location and settings of a driver.
struct DriverLocation {
  std::string path;      ///< path of the shared object, or name of a shipped driver (findDriver)
  std::string locator;   ///< device to open, e.g. a port or a serial number, in the driver's format
  std::string settings;  ///< in the driver's format
};

/// Caller of a driver's read and write.
enum class CalledBy {
  kLoop,  ///< the tick: drivers that may block are refused
  kHost   ///< a separate process (devices/host)
};

/// Description of a shared object before any device is opened.
struct PluginFacts {
  std::string name;  ///< name for people
  int major = 0, minor = 0;
  bool never_waits = false;
};

/// Loads the shared object and describes it. Refused like PluginDriver::load(), except for errors
/// of a device.
[[nodiscard]] Expected<PluginFacts> pluginFacts(const std::string& name);

/// A driver loaded from a shared object (wholehand/device.h), with its device open but not
/// enabled. The device stays open between armings: it is found and homed once.
class PluginDriver final : public DeviceDriver {
 public:
  /// Loads the driver, opens its device and reads its axes. Refused, each with its own message: no
  /// such file, no `wh_plugin_v1`, another major version, a structure that ends before a required
  /// function, a driver that may block where the loop calls it, a device that is not found.
  /// @param report receives the driver's log lines, and says, from another thread, while the
  ///   opening or closing device does not answer; may be null
  [[nodiscard]] static Expected<std::shared_ptr<PluginDriver>> load(
      const DriverLocation& location, std::function<void(const std::string&)> report = nullptr,
      CalledBy called_by = CalledBy::kLoop);
  /// Closes the device. The code stays loaded because the driver's own threads may still run in it.
  ~PluginDriver() override;
  PluginDriver(const PluginDriver&) = delete;
  PluginDriver& operator=(const PluginDriver&) = delete;

  [[nodiscard]] const DriverLocation& location() const noexcept { return location_; }
  /// True when read and write never block (WH_NEVER_WAITS).
  [[nodiscard]] bool neverWaits() const noexcept { return never_waits_; }
  [[nodiscard]] std::string where() const override { return "the driver " + location_.path; }
  [[nodiscard]] std::string name() const override;
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override;
  [[nodiscard]] Expected<Done> enable(const wh_command& neutral) override;
  [[nodiscard]] double switchesWithin_s() const noexcept override;
  [[nodiscard]] bool enablesAtNeutral() const noexcept override;
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept override;
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept override;

 private:
  PluginDriver(DriverLocation location, std::function<void(const std::string&)> report);
  [[nodiscard]] Expected<Done> open();
  [[nodiscard]] Expected<Done> describe();
  void identify();
  [[nodiscard]] Diagnostic failed(const std::string& what, const std::string& remedy) const;
  static void take(void* self, const char* line);

  DriverLocation location_;
  std::function<void(const std::string&)> report_;
  std::string last_line_;  ///< last log line of the driver
  wh_host host_{};
  const wh_plugin* plugin_ = nullptr;
  wh_device* device_ = nullptr;
  bool never_waits_ = false;
  std::vector<wh_axis> axes_;
};

}  // namespace wholehand
