// The driver `frame`: a FrameDevice with the interface of device.h, and a thread for its bus.
#include "drivers/frame/frame_device.hpp"
#include "drivers/identity_text.hpp"
#include "drivers/sized_sample.hpp"
#include "loop/realtime/monotonic_clock.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>
#include <exception>
#include <mutex>
#include <poll.h>
#include <pthread.h>
#include <random>
#include <sched.h>
#include <string>
#include <thread>
#include <utility>

namespace {

constexpr double kCycle_s = 250e-6;  // longest time between two looks for a command
constexpr int kBusPriority = 85;     // the loop has 80

std::int64_t waitAMillisecond() {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return wholehand::monotonicNow_ns();
}

std::uint32_t drawSession() {
  std::random_device draw;
  return std::max(1U, static_cast<std::uint32_t>(draw()));
}

}  // namespace

struct wh_device {
  wh_device(const wh_host& at, std::unique_ptr<wholehand::FrameDevice> opened)
      : host(at), device(std::move(opened)), bus([this] { run(); }) {
    const sched_param urgent{kBusPriority};
    (void)::pthread_setschedparam(bus.native_handle(), SCHED_FIFO, &urgent);
  }
  ~wh_device() {
    (void)control(WH_DISABLE, 0.0);
    ended.store(true);
    bus.join();
  }
  wh_device(const wh_device&) = delete;
  wh_device& operator=(const wh_device&) = delete;

  wholehand::Expected<wholehand::Done> control(std::uint32_t verb, double argument) {
    const std::lock_guard lock(pumping);
    return device->control(verb, argument, &waitAMillisecond);
  }

  void run() {
    const int descriptor = device->carrier().descriptor();
    while (!ended.load()) {
      {
        const std::lock_guard lock(pumping);
        device->pump(wholehand::monotonicNow_ns());
      }
      const timespec cycle{0, static_cast<long>(kCycle_s * 1e9)};
      pollfd input{descriptor, POLLIN, 0};
      if (descriptor >= 0) (void)::ppoll(&input, 1, &cycle, nullptr);
      // A closed line is always ready, so poll() does not wait.
      if (descriptor < 0 || (input.revents & (POLLHUP | POLLERR)) != 0) {
        (void)::nanosleep(&cycle, nullptr);
      }
    }
  }

  wh_host host;
  std::unique_ptr<wholehand::FrameDevice> device;
  std::mutex pumping;  // locked by the bus thread or by control(), never by the loop
  std::atomic<bool> ended{false};
  std::thread bus;
};

namespace {

void report(const wh_host& host, const wholehand::Diagnostics& errors) {
  host.say(host.context, wholehand::format(errors).c_str());
}

int openDevice(const wh_host* host, const char* locator, const char* settings, wh_device** out) {
  try {
    if (*settings != 0) {
      host->say(host->context, "the driver frame has no settings: leave out --driver-settings");
      return WH_FAILED;
    }
    auto carrier = wholehand::openCarrier(locator);
    if (!carrier) {
      report(*host, carrier.errors());
      return WH_FAILED;
    }
    auto device =
        wholehand::FrameDevice::open(std::move(carrier).value(), drawSession(), &waitAMillisecond);
    if (!device) {
      report(*host, device.errors());
      return WH_FAILED;
    }
    *out = new wh_device(*host, std::move(device).value());
    return WH_OK;
  } catch (const std::exception& error) {  // no memory, no thread; no exception may leave the
                                           // plugin
    host->say(host->context, error.what());
    return WH_FAILED;
  }
}

int describe(wh_device* device, wh_axis* axes, std::uint32_t capacity, std::uint32_t* count) {
  const std::vector<wh_axis>& has = device->device->axes();
  *count = static_cast<std::uint32_t>(has.size());
  for (std::uint32_t i = 0; i < std::min(capacity, *count); ++i) {
    const std::uint32_t size = axes[i].size;
    wh_axis axis = has[i];
    axis.delay_s += 2.0 * kCycle_s;  // a sample and a command each wait for the bus for up to a
                                     // cycle
    std::memcpy(&axes[i], &axis, std::min<std::size_t>(size, sizeof(axis)));
    axes[i].size = size;
  }
  return WH_OK;
}

int control(wh_device* device, std::uint32_t verb, double argument) {
  const auto done = device->control(verb, argument);
  if (done) return WH_OK;
  report(device->host, done.errors());
  return done.errors().front().value == std::to_string(WH_UNSUPPORTED) ? WH_UNSUPPORTED : WH_FAILED;
}

// The firmware begins at the neutral effort of its own board; then these efforts apply.
int enable(wh_device* device, const wh_command* neutral) {
  const int enabled = control(device, WH_ENABLE, 0.0);
  return enabled < 0 ? enabled : device->device->write(*neutral);
}

int readSample(wh_device* device, wh_sample* sample) {
  return wholehand::readSized(*sample,
                              [device](wh_sample& newest) { return device->device->read(newest); });
}

int writeCommand(wh_device* device, const wh_command* command) {
  return command->size < sizeof(wh_command) ? WH_FAILED : device->device->write(*command);
}

void closeDevice(wh_device* device) {
  delete device;
}

int identify(wh_device* device, wh_identity* identity) {
  wholehand::fill(identity->serial, device->device->serial());
  wholehand::fill(identity->firmware, device->device->firmware());
  wholehand::fill(identity->sdk, "frame " + std::to_string(WF_VERSION));
  return WH_OK;
}

}  // namespace

const wh_plugin* wh_plugin_v1() {
  static const wh_plugin kPlugin = {sizeof(wh_plugin),
                                    WH_MAJOR,
                                    WH_MINOR,
                                    WH_NEVER_WAITS,
                                    "frame",
                                    openDevice,
                                    describe,
                                    control,
                                    readSample,
                                    writeCommand,
                                    closeDevice,
                                    identify,
                                    enable,
                                    2.5,
                                    0.1};
  return &kPlugin;
}
