// The driver `composite`: joins two drivers into one, with the interface of device.h.
#include "devices/plugin/plugin_driver.hpp"
#include "drivers/composite/composite.hpp"
#include "drivers/identity_text.hpp"
#include "drivers/sized_sample.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>
#include <utility>

struct wh_device {
  wh_host host;
  double longest_skew_s;
  std::unique_ptr<wholehand::Composite> whole;
};

namespace {

// Its flags and its enable() depend on the parts, which are known once they are open.
wh_plugin& plugin();
int enable(wh_device* device, const wh_command* neutral);

// Says all errors in one line, which is what say() takes.
void report(const wh_host& host, const wholehand::Diagnostics& errors) {
  std::string line = wholehand::format(errors);
  std::replace(line.begin(), line.end(), '\n', ' ');
  host.say(host.context, line.c_str());
}

// Result of a verb. WH_UNSUPPORTED: no part failed, and one cannot do it.
int result(const wh_device& device, const wholehand::Expected<wholehand::Done>& done) {
  if (done) return WH_OK;
  const bool unsupported = std::all_of(
      done.errors().begin(), done.errors().end(), [](const wholehand::Diagnostic& error) {
        return error.problem.starts_with(wholehand::kUnsupportedPrefix);
      });
  if (unsupported) return WH_UNSUPPORTED;
  report(device.host, done.errors());
  return WH_FAILED;
}

wholehand::Expected<std::unique_ptr<wh_device>> openParts(const wh_host& host,
                                                          const std::string& file) {
  auto config = wholehand::loadCompositeFile(file);
  if (!config) return config.errors();
  wholehand::Composite::Parts parts;
  bool never_waits = true;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    auto part = wholehand::PluginDriver::load(
        config->parts[p].driver,
        [host](const std::string& line) { host.say(host.context, line.c_str()); },
        wholehand::CalledBy::kHost);
    if (!part) return part.errors();
    never_waits = never_waits && (*part)->neverWaits();
    parts[p] = *part;
  }
  auto whole = wholehand::Composite::make(*config, parts);
  if (!whole) return whole.errors();
  plugin().flags = never_waits ? WH_NEVER_WAITS : 0;
  plugin().enable = (*whole)->enablesAtNeutral() ? &enable : nullptr;
  plugin().switches_within_s = parts[0]->switchesWithin_s() + parts[1]->switchesWithin_s();
  return std::unique_ptr<wh_device>(
      new wh_device{host, config->longest_skew_s, std::move(whole).value()});
}

int openDevice(const wh_host* host, const char* locator, const char* settings, wh_device** out) {
  try {
    if (*locator != 0 || *settings == 0) {
      host->say(host->context,
                "the driver composite takes a file that names its two devices: "
                "--driver-settings FILE, and no --device-at");
      return WH_FAILED;
    }
    auto device = openParts(*host, settings);
    if (!device) {
      report(*host, device.errors());
      return WH_FAILED;
    }
    *out = std::move(device).value().release();
    return WH_OK;
  } catch (const std::exception& error) {  // e.g. no memory; no exception may leave the plugin
    host->say(host->context, error.what());
    return WH_FAILED;
  }
}

int describe(wh_device* device, wh_axis* axes, std::uint32_t capacity, std::uint32_t* count) {
  const std::vector<wh_axis>& has = device->whole->axes();
  *count = static_cast<std::uint32_t>(has.size());
  for (std::uint32_t i = 0; i < std::min(capacity, *count); ++i) {
    const std::uint32_t size = axes[i].size;
    std::memcpy(&axes[i], &has[i], std::min<std::size_t>(size, sizeof(wh_axis)));
    axes[i].size = size;
  }
  return WH_OK;
}

int control(wh_device* device, std::uint32_t verb, double argument) {
  return result(*device, device->whole->control(verb, argument));
}

int enable(wh_device* device, const wh_command* neutral) {
  return result(*device, device->whole->enable(*neutral));
}

int readSample(wh_device* device, wh_sample* sample) {
  return wholehand::readSized(*sample,
                              [device](wh_sample& newest) { return device->whole->read(newest); });
}

int writeCommand(wh_device* device, const wh_command* command) {
  return command->size < sizeof(wh_command) ? WH_FAILED : device->whole->write(*command);
}

void closeDevice(wh_device* device) {
  (void)device->whole->control(WH_DISABLE, 0.0);
  std::array<char, 120> line{};
  std::snprintf(
      line.data(), line.size(), "largest skew between the two samples %.3f ms, allowed %.3f ms",
      static_cast<double>(device->whole->largestSkew_ns()) * 1e-6, device->longest_skew_s * 1e3);
  device->host.say(device->host.context, line.data());
  delete device;
}

int identify(wh_device* device, wh_identity* identity) {
  const wholehand::DriverIdentity both = device->whole->identity();
  wholehand::fill(identity->serial, both.serial);
  wholehand::fill(identity->firmware, both.firmware);
  wholehand::fill(identity->sdk, both.sdk);
  return WH_OK;
}

wh_plugin& plugin() {
  static wh_plugin made = {sizeof(wh_plugin), WH_MAJOR, WH_MINOR, WH_NEVER_WAITS, "composite",
                           openDevice,        describe, control,  readSample,     writeCommand,
                           closeDevice,       identify, enable,   60.0,           0.0};
  return made;
}

}  // namespace

const wh_plugin* wh_plugin_v1() {
  plugin().flags = WH_NEVER_WAITS;  // preliminary; open() sets it from the parts
  plugin().enable = nullptr;
  return &plugin();
}
