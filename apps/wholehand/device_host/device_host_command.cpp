#include "apps/wholehand/device_host/device_host_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/options.hpp"
#include "devices/host/device_host.hpp"
#include "devices/host/host_segment.hpp"
#include "devices/plugin/device_driver.hpp"
#include "devices/plugin/plugin_device.hpp"
#include "files/device/device_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/model/device_model.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/realtime/periodic_thread.hpp"
#include "loop/runtime/interrupt_scope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <thread>
#include <unistd.h>

namespace wholehand {
namespace {

constexpr std::chrono::milliseconds kLookEvery{5};
constexpr int kHostPriority = 85;  // the loop has 80
constexpr double kDelayOfAnyLoop_s = 1.0;

// Line for an event; empty: not worth reporting.
std::string lineAbout(const HostEvent& event) {
  if (event.of_drive) {
    const double heard_ms = static_cast<double>(event.heard_ns) * 1e-6;
    const bool on = event.drive == DriveState::kOn;
    return fmt::format("session {}: the drive {} (heard {:.1f} ms ago){}", event.session,
                       describe(event.drive), heard_ms,
                       on ? "" : "; this host enables it only when a loop arms");
  }
  const double silent_ms = static_cast<double>(event.silent_ns) * 1e-6;
  const double gap_ms = static_cast<double>(event.longest_gap_ns) * 1e-6;
  switch (event.phase) {
    case HostPhase::kWaiting:
      return fmt::format("session {}: enabled by process {}", event.session, event.loop_pid);
    case HostPhase::kRendering:
      return {};
    case HostPhase::kRamping:
      if (event.reason == ReleaseReason::kNone) {
        return fmt::format(
            "session {}: the loop ended at neutral; the device follows (this host's longest gap "
            "{:.1f} ms)",
            event.session, gap_ms);
      }
      return fmt::format(
          "session {}: LETS GO: {} (its last is {:.1f} ms old; this host's longest "
          "gap {:.1f} ms)",
          event.session, describe(event.reason), silent_ms, gap_ms);
    case HostPhase::kLatched:
      return fmt::format(
          "session {}: at neutral, and stays there until a loop arms anew: {} (this "
          "host's longest gap {:.1f} ms)",
          event.session, describe(event.reason), gap_ms);
    case HostPhase::kIdle:
      return fmt::format("session {}: ended", event.session);
  }
  return {};
}

// Cycles until the host ends by itself or by a signal.
Expected<Done> hold(DeviceHost& host, const ObservedDriver& driver,
                    const DeviceHostOptions& options) {
  Interrupts& interrupts = InterruptScope::shared();
  PeriodicThreadConfig config;
  config.period_ns = std::llround(1e9 / options.rate_hz);
  config.setup.fifo_priority = kHostPriority;
  config.setup.cores_before_last = 1;  // the loop uses the last core
  PeriodicThread thread(config, [&host](std::uint32_t elapsed_periods, std::int64_t) {
    return host.cycle(static_cast<int>(std::min(elapsed_periods, 1'000'000U)));
  });
  // Starts the real-time thread of the host.
  interrupts.loops.fetch_add(1);
  Expected<SetupReport> setup = thread.start();
  if (!setup) {
    interrupts.loops.fetch_sub(1);
    return setup.errors();
  }
  for (const SetupLine& line : *setup) {
    if (!line.granted) std::printf("  machine  %s: %s\n", line.what.c_str(), line.sentence.c_str());
  }
  const auto print_events = [&] {
    HostEvent event;
    while (host.nextEvent(event)) {
      const std::string line = lineAbout(event);
      if (!line.empty())
        std::printf("%s: %s\n", printable(options.name).c_str(), printable(line, 1000).c_str());
    }
  };
  // Prints events until the thread ends, and whether the driver answers.
  for (bool silent = false; thread.running();) {
    std::this_thread::sleep_for(kLookEvery);
    if (driver.facts().overdue != silent) {
      silent = !silent;
      std::printf("%s: %s\n", printable(options.name).c_str(), silent ? kNoAnswer : kAnswersAgain);
    }
    if (InterruptScope::interrupted()) host.requestEnd();
    print_events();
  }
  thread.join();
  interrupts.loops.fetch_sub(1);
  print_events();
  return Done{};
}

}  // namespace

int deviceHostCommand(const DeviceHostOptions& options) {
  auto lock = HostLock::take(options.name);  // taken before the device is touched
  if (!lock) return refuse(lock.errors());
  auto model = loadDeviceFile(options.device);
  if (!model) return refuse(model.errors());
  const InterruptScope interrupts;
  const auto print_line = [&options](const std::string& line) {
    std::printf("%s: %s\n", printable(options.name).c_str(), printable(line, 1000).c_str());
  };
  auto driver = PluginDriver::load(options.driver, print_line, CalledBy::kHost);
  if (!driver) return refuse(driver.errors());
  // Any delay is accepted here; the loop, which knows its period, checks it.
  auto fits = PluginDevice::make(*driver, *model, kDelayOfAnyLoop_s);
  if (!fits) return refuse(fits.errors());
  auto segment = HostSegment::create(**lock);
  if (!segment) return refuse(segment.errors());
  const GuardConfig config = guardConfig(**driver, *model, 1.0 / options.rate_hz);
  ObservedDriver observed(*driver);
  DeviceHost host(observed, (*segment)->frame(), config, &monotonicNow_ns);
  describeDevice((*segment)->frame(), **driver, config, ::getpid());
  std::printf("%s: holds %s, %zu axes; a loop takes it with: wholehand run --host %s\n",
              options.name.c_str(), (*driver)->name().c_str(), (*driver)->axes().size(),
              options.name.c_str());
  if (auto held = hold(host, observed, options); !held) return refuse(held.errors());
  return kExitDone;
}

void addDeviceHost(CLI::App& app, DeviceHostOptions& o, int& code) {
  CLI::App* host = app.add_subcommand(
      "device-host", "Hold a device for `run` in another process; ramp to neutral if that dies");
  host->add_option("--name", o.name, "Name by which `run --host` finds it")->required();
  host->add_option("--driver", o.driver.path,
                   "Driver of the device (docs/drivers.md): a name or a path")
      ->required();
  host->add_option("--device-at", o.driver.locator,
                   "Which device, as the driver names it: a serial number, a port ...");
  host->add_option("--driver-settings", o.driver.settings, "The driver's own settings");
  host->add_option("--device", o.device, "Device file, the same as the loop's")->required();
  host->add_option("--rate-hz", o.rate_hz, "Cycles a second; the host adds two cycles to the delay")
      ->check(finiteBetween(1000.0, 16000.0, "Hz"))
      ->capture_default_str();
  host->footer("Ctrl-C takes the effort to neutral, disables the device and ends.");
  host->callback([&o, &code] { code = deviceHostCommand(o); });
}

}  // namespace wholehand
