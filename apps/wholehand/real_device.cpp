#include "real_device.hpp"

#include "commissioning/daily_check.hpp"
#include "device/host/hosted_driver.hpp"
#include "device/plugin/observed_driver.hpp"
#include "device/plugin/plugin_device.hpp"
#include "realtime/monotonic_clock.hpp"

#include <utility>

namespace wholehand {
namespace {

// Below 0: none yet.
double age_s(std::int64_t at_ns) {
  return at_ns == 0 ? -1.0 : static_cast<double>(monotonicNow_ns() - at_ns) * 1e-9;
}

DeviceStatus statusOf(const ObservedDriver& driver) {
  const DeviceFacts facts = driver.facts();
  DeviceStatus out;
  out.enabled = facts.enabled;
  out.homed = facts.homed;
  out.silenced = facts.silenced;
  out.temperature_c = facts.temperature_c;
  out.sample_age_s = age_s(facts.sampled_ns);
  return out;
}

static_assert(static_cast<int>(ReleaseReason::kNeverCommanded) ==
              static_cast<int>(HostReason::kNeverCommanded));

// Passport entry of a recording without a passport.
constexpr const char* kWithout = "without";

// The certificate of a real device is based on its passport, which must be valid at every arming.
Expected<Done> usePassport(const RunOptions& options, const DeviceDriver& driver,
                           StationConfig& config) {
  if (options.without_passport) {
    config.rig.passport = kWithout;
    return Done{};
  }
  const auto model = loadDeviceFile(options.files.device);
  if (!model) return model.errors();
  const auto cleared =
      clearToArm(driver.identity(), *model, 1.0 / config.rig.period_s, placeTimeNow());
  if (!cleared) return cleared.errors();
  const Passport& passport = cleared->passport;
  config.rig.measured = worstCorners(*model, passport, config.rig.period_s);
  config.rig.passport = passport.sha256;
  config.real_time_required = true;
  auto text = readWhole(passport.path);
  if (!text) return text.errors();
  config.rig.passport_text = std::move(*text);
  return Done{};
}

Expected<Clearance> stillCleared(const DeviceDriver& driver, const DeviceModel& model,
                                 const std::string& armed_with, double period_s) {
  if (armed_with == kWithout) return Clearance::withoutPassport();
  const auto cleared = clearToArm(driver.identity(), model, 1.0 / period_s, placeTimeNow());
  if (!cleared) return cleared.errors();
  if (cleared->clearance.passport() == armed_with) return cleared->clearance;
  return Diagnostic{
      cleared->passport.path,   0, "", "", "the passport was replaced while this program runs",
      "start the program again"};
}

// The connection to a device: its driver, and the host that holds it, if any.
struct Plugged {
  std::shared_ptr<DeviceDriver> driver;
  std::shared_ptr<HostedDriver> host;  ///< null: the loop calls the driver itself
};

Expected<Plugged> plugIn(const RunOptions& options, Terminal& terminal) {
  if (!options.host.empty()) {
    auto hosted = HostedDriver::connect(options.host);
    if (!hosted) return hosted.errors();
    return Plugged{*hosted, *hosted};
  }
  auto loaded = PluginDriver::load(options.driver,
                                   [&terminal](const std::string& line) { terminal.say(line); });
  if (!loaded) return loaded.errors();
  return Plugged{*loaded, nullptr};
}

DeviceStatus statusOf(const ObservedDriver& driver, const HostedDriver* host) {
  DeviceStatus status = statusOf(driver);
  if (host == nullptr) return status;
  status.hosted = true;
  status.host_age_s = age_s(host->cycleNs());
  status.let_go = static_cast<ReleaseReason>(host->reason());
  return status;
}

}  // namespace

Expected<std::shared_ptr<DeviceDriver>> useDriver(RunOptions& options, StationConfig& config,
                                                  Terminal& terminal) {
  if (!isRealDevice(options)) return std::shared_ptr<DeviceDriver>();
  if (Diagnostics refused = refuseForPersons(options.engine); !refused.empty()) return refused;
  options.wait = true;
  auto plugged = plugIn(options, terminal);
  if (!plugged) return plugged.errors();
  if (auto ready = usePassport(options, *plugged->driver, config); !ready) return ready.errors();
  auto observed = std::make_shared<ObservedDriver>(plugged->driver);
  config.device_status = [observed, host = plugged->host] {
    return statusOf(*observed, host.get());
  };
  config.make_device = [observed, plugged = *plugged, passport = config.rig.passport,
                        period_s = config.rig.period_s](
                           const DeviceModel& model) -> Expected<std::unique_ptr<HapticDevice>> {
    // Checked on the connection that arms: a host may have been started again with another device.
    if (auto found = observed->reconnect(); !found) return found.errors();
    if (plugged.host) {
      if (Diagnostics other = plugged.host->differences(model); !other.empty()) return other;
    }
    auto clearance = stillCleared(*plugged.driver, model, passport, period_s);
    if (!clearance) return clearance.errors();
    return PluginDevice::make(observed, model, period_s, std::move(*clearance));
  };
  return plugged->driver;
}

void warnOfNoPassport(Terminal& terminal) {
  terminal.say("************************************************************");
  terminal.say("WITHOUT PASSPORT: nothing of this device was measured.");
  terminal.say("NOBODY MAY BE ATTACHED TO IT. The recording says so.");
  terminal.say("************************************************************");
}

}  // namespace wholehand
