// The driver as device.h wants it: exceptions end here.
#include "bus_clock.hpp"
#include "can_bus.hpp"
#include "moteus_device.hpp"
#include "settings.hpp"
#include "wholehand/device.h"

#include <exception>
#include <memory>
#include <string>
#include <utility>

using namespace wholehand;
using namespace wholehand::moteus;

struct wh_device {
  wh_host host;
  std::unique_ptr<MoteusDevice> moteus;
};

namespace {

void say(const wh_host& host, const std::string& line) {
  host.say(host.context, line.c_str());
}

int refuse(const wh_host& host, const Diagnostics& why) {
  for (const Diagnostic& one : why) say(host, format(one));
  return WH_FAILED;
}

int openOrThrow(const wh_host& host, const std::string& locator, const std::string& path,
                wh_device** out) {
  if (path.empty()) {
    say(host, "needs a settings file: --driver-settings FILE.toml");
    return WH_FAILED;
  }
  Expected<Settings> settings = loadSettings(path);
  if (!settings) return refuse(host, settings.errors());
  Expected<std::unique_ptr<CanBus>> bus = openCanBus(locator);
  if (!bus) return refuse(host, bus.errors());
  auto device = std::make_unique<wh_device>();
  device->host = host;
  device->moteus = std::make_unique<MoteusDevice>(
      std::move(*settings), std::move(*bus), std::make_unique<MonotonicClock>(),
      [from = device.get()](const std::string& line) { say(from->host, line); });
  if (const Expected<Done> checked = device->moteus->check(); !checked) {
    return refuse(host, checked.errors());
  }
  *out = device.release();
  return WH_OK;
}

// What throws says so and fails.
template <class Function>
int guarded(const wh_host& host, Function function) {
  try {
    return function();
  } catch (const std::exception& error) {
    host.say(host.context, error.what());
  } catch (...) {
    host.say(host.context, "an unknown error");
  }
  return WH_FAILED;
}

int openDevice(const wh_host* host, const char* locator, const char* settings, wh_device** out) {
  return guarded(*host, [&] { return openOrThrow(*host, locator, settings, out); });
}

int describe(wh_device* device, wh_axis* axes, uint32_t capacity, uint32_t* count) {
  device->moteus->describe(axes, capacity, *count);
  return WH_OK;
}

int control(wh_device* device, uint32_t verb, double) {
  return guarded(device->host, [&] { return device->moteus->control(verb); });
}

int readSample(wh_device* device, wh_sample* sample) {
  return device->moteus->read(*sample);
}

int writeCommand(wh_device* device, const wh_command* command) {
  return device->moteus->write(*command);
}

void closeDevice(wh_device* device) {
  delete device;
}

int identify(wh_device* device, wh_identity* identity) {
  return guarded(device->host, [&] {
    device->moteus->identify(*identity);
    return static_cast<int>(WH_OK);
  });
}

}  // namespace

const wh_plugin* wh_plugin_v1(void) {
  static const wh_plugin kPlugin = {sizeof(wh_plugin), WH_MAJOR,     WH_MINOR,    WH_NEVER_WAITS,
                                    "moteus drives",   openDevice,   describe,    control,
                                    readSample,        writeCommand, closeDevice, identify};
  return &kPlugin;
}
