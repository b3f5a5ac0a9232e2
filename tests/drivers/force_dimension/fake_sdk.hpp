#pragma once

#include "devices/plugin/plugin_driver.hpp"
#include "fake_drd.h"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <dlfcn.h>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

/// The driver, loaded as a host loads it, with a fake SDK.
namespace wholehand::test {

inline constexpr const char* kForceSettings = R"(kind = "force-dimension"
version = 1
delay_s = 0.001
watchdog_s = 0.02
yaw_rad = 3.141592653589793
force_limit_n = 12.0
half_travel_m = 0.1125
step_m = 1e-5
)";
inline constexpr const char* kGripperSettings = R"([gripper]
axis = "finger_flexion"
open_rad = 0.5
closed_rad = 0.1
flexion_rad = 1.6
lever_m = 0.07
force_limit_n = 8.0
step_rad = 1e-4
)";

inline std::string sdkFolder(const std::string& kind) {
  return std::string(WHOLEHAND_BINARY_DIR) + "/fake_sdk/" + kind;
}

class ForceDimensionDriver {
 public:
  explicit ForceDimensionDriver(const std::string& sdk = "current") {
    ::setenv("FORCEDIM_SDK", sdkFolder(sdk).c_str(), 1);
    const std::string path = sdkFolder(sdk) + "/libdrd.so.3";
    library_ = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library_ == nullptr) return;  // no library is loaded
    const auto find = reinterpret_cast<fake_device* (*)(int)>(::dlsym(library_, "fake_drd"));
    fake = find(1);
  }
  ~ForceDimensionDriver() {
    driver.reset();
    ::unsetenv("FORCEDIM_SDK");
  }
  ForceDimensionDriver(const ForceDimensionDriver&) = delete;
  ForceDimensionDriver& operator=(const ForceDimensionDriver&) = delete;

  Expected<std::shared_ptr<PluginDriver>> load(
      const std::string& locator = "",
      const std::string& settings = std::string(kForceSettings) + kGripperSettings,
      CalledBy called_by = CalledBy::kHost) {
    const std::string path = folder_.file("device.toml");
    std::ofstream(path) << settings;
    auto loaded = PluginDriver::load(
        {std::string(WHOLEHAND_BINARY_DIR) + "/drivers/force_dimension.so", locator, path},
        [this](const std::string& line) { said += line + "\n"; }, called_by);
    if (loaded) driver = *loaded;
    return loaded;
  }
  wh_sample read() {
    wh_sample sample{};
    sample.size = sizeof sample;
    returned = driver->read(sample);
    return sample;
  }
  int write(const std::vector<double>& effort) {
    wh_command command{};
    command.size = sizeof command;
    command.axes = static_cast<std::uint32_t>(effort.size());
    for (std::size_t i = 0; i < effort.size(); ++i) command.effort[i] = effort[i];
    return driver->write(command);
  }

  fake_device* fake = nullptr;
  std::shared_ptr<PluginDriver> driver;
  std::string said;
  int returned = 0;

 private:
  Folder folder_;
  void* library_ = nullptr;
};

inline std::string whyNot(const Expected<std::shared_ptr<PluginDriver>>& driver) {
  return driver ? "was loaded" : format(driver.errors());
}

class ForceDimension : public testing::Test {
 protected:
  void open(const std::string& locator = "") {
    const auto driver = at.load(locator);
    ASSERT_TRUE(driver) << whyNot(driver);
  }
  void enable() {
    open();
    ASSERT_TRUE(at.driver->control(WH_ENABLE, 0.0)) << at.said;
  }
  ForceDimensionDriver at;
};

}  // namespace wholehand::test
