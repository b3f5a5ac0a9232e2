// The driver as device.h wants it: exceptions end here.
#include "force_dimension_device.hpp"
#include "force_settings.hpp"
#include "sdk.hpp"
#include "wholehand/device.h"

#include <exception>
#include <memory>
#include <string>
#include <utility>

using namespace wholehand;
using namespace wholehand::force_dimension;

struct wh_device {
  wh_host host;
  std::unique_ptr<ForceDimensionDevice> opened;
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
  const Expected<ForceSettings> settings = loadForceSettings(path);
  if (!settings) return refuse(host, settings.errors());
  Expected<Sdk> sdk = loadSdk();
  if (!sdk) return refuse(host, sdk.errors());
  auto device = std::make_unique<wh_device>();
  device->host = host;
  auto opened = ForceDimensionDevice::open(
      std::move(*sdk), *settings, locator,
      [from = device.get()](const std::string& line) { say(from->host, line); });
  if (!opened) return refuse(host, opened.errors());
  device->opened = std::move(*opened);
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
  device->opened->describe(axes, capacity, *count);
  return WH_OK;
}

int control(wh_device* device, uint32_t verb, double) {
  return guarded(device->host, [&] { return device->opened->control(verb); });
}

int readSample(wh_device* device, wh_sample* sample) {
  return device->opened->read(*sample);
}

int writeCommand(wh_device* device, const wh_command* command) {
  return device->opened->write(*command);
}

void closeDevice(wh_device* device) {
  delete device;
}

int identify(wh_device* device, wh_identity* identity) {
  device->opened->identify(*identity);
  return WH_OK;
}

}  // namespace

const wh_plugin* wh_plugin_v1(void) {
  // Not WH_NEVER_WAITS: the SDK waits for its bus and its time guard, and runs threads of its own.
  static const wh_plugin kPlugin = {sizeof(wh_plugin), WH_MAJOR,     WH_MINOR,    0,
                                    "Force Dimension", openDevice,   describe,    control,
                                    readSample,        writeCommand, closeDevice, identify};
  return &kPlugin;
}
