#pragma once

#include "loop/core/expected.hpp"
#include "wholehand/device.h"

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace wholehand {

/// A device in C++ behind the functions of device.h; a driver derives its wh_device from it. No
/// exception passes this boundary: it is reported to the host, and the call fails.
template <class Device>
struct OpenedDevice {
  using Report = std::function<void(const std::string& line)>;
  /// Opens a device from a locator and a settings file; `report` lives as long as the device.
  using Open = Expected<std::unique_ptr<Device>> (*)(const std::string& locator,
                                                     const std::string& settings,
                                                     const Report& report);

  wh_host host;
  std::unique_ptr<Device> device;

  void report(const std::string& line) const { host.say(host.context, line.c_str()); }

  template <class Function>
  [[nodiscard]] int guard(Function function) const {
    try {
      return function();
    } catch (const std::exception& error) {
      host.say(host.context, error.what());
    } catch (...) {
      host.say(host.context, "an unknown error");
    }
    return WH_FAILED;
  }
};

/// The functions of wh_plugin for drivers whose wh_device is `Opened`. They need a settings file.
template <class Opened, typename Opened::Open open>
struct PluginFunctions {
  [[nodiscard]] static constexpr wh_plugin table(std::uint32_t flags, const char* name,
                                                 double opens_within_s, double switches_within_s) {
    return {sizeof(wh_plugin), WH_MAJOR,  WH_MINOR, flags,          name,
            &openDevice,       &describe, &control, &readSample,    &writeCommand,
            &closeDevice,      &identify, nullptr,  opens_within_s, switches_within_s};
  }
  static int openDevice(const wh_host* host, const char* locator, const char* settings,
                        Opened** out) {
    return Opened{{*host, nullptr}}.guard([&] {
      auto opened = std::make_unique<Opened>();
      opened->host = *host;
      if (*settings == 0) {
        opened->report("needs a settings file: --driver-settings FILE.toml");
        return WH_FAILED;
      }
      auto device = open(locator, settings,
                         [to = opened.get()](const std::string& line) { to->report(line); });
      if (!device) {
        for (const Diagnostic& one : device.errors()) opened->report(format(one));
        return WH_FAILED;
      }
      opened->device = std::move(device).value();
      *out = opened.release();
      return WH_OK;
    });
  }
  static int describe(Opened* device, wh_axis* axes, std::uint32_t capacity, std::uint32_t* count) {
    device->device->describe(axes, capacity, *count);
    return WH_OK;
  }
  static int control(Opened* device, std::uint32_t verb, double) {
    return device->guard([&] { return device->device->control(verb); });
  }
  static int readSample(Opened* device, wh_sample* sample) { return device->device->read(*sample); }
  static int writeCommand(Opened* device, const wh_command* command) {
    return device->device->write(*command);
  }
  static void closeDevice(Opened* device) { delete device; }
  static int identify(Opened* device, wh_identity* identity) {
    return device->guard([&] {
      device->device->identify(*identity);
      return WH_OK;
    });
  }
};

}  // namespace wholehand
