// wholehand device inspect: what a driver reports of its device.
#include "core/printable.hpp"
#include "device/plugin/plugin_device.hpp"
#include "device_command.hpp"
#include "exit_code.hpp"
#include "model/device_model.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>

namespace wholehand {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPeriod_s = 1e-3;  // default of `run`

const char* effortName(std::uint32_t meaning) {
  switch (meaning) {
    case WH_EFFORT:
      return "effort";
    case WH_POSITION_LIMIT:
      return "position limit";
    case WH_BRAKE:
      return "brake";
    case WH_VIBRATION:
      return "vibration";
    default:
      return "unknown";
  }
}

std::string statusText(const wh_sample& sample) {
  static constexpr std::pair<std::uint32_t, const char*> kBits[] = {
      {WH_ENABLED, "enabled"},         {WH_HOMED, "homed"}, {WH_SATURATED, "saturated"},
      {WH_DRIVE_FAULT, "drive fault"}, {WH_HOT, "hot"},     {WH_DERATING, "derating"},
      {WH_SILENCED, "silenced"}};
  std::vector<std::string_view> words;
  for (const auto& [bit, word] : kBits) {
    if ((sample.status & bit) != 0) words.emplace_back(word);
  }
  return words.empty() ? "not enabled, not homed" : fmt::format("{}", fmt::join(words, ", "));
}

// NaN becomes null, since JSON has no NaN.
Json numberOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string orDash(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

Json axisJson(const wh_axis& axis, const wh_sample& sample, std::size_t i) {
  const bool measured = (sample.valid >> i & 1U) != 0;
  return {{"name", axis.name},
          {"kind", axis.kind == WH_ROTATION ? "rotation" : "translation"},
          {"effort_meaning", effortName(axis.effort_meaning)},
          {"lower", numberOrNull(axis.lower)},
          {"upper", numberOrNull(axis.upper)},
          {"effort_limit", numberOrNull(axis.effort_limit)},
          {"resolution", numberOrNull(axis.resolution)},
          {"delay_s", numberOrNull(axis.delay_s)},
          {"silence_s", numberOrNull(axis.silence_s)},
          {"position", measured ? numberOrNull(sample.position[i]) : Json(nullptr)},
          {"temperature_c", numberOrNull(sample.temperature_c[i])}};
}

void printAxes(const std::vector<wh_axis>& axes, const wh_sample& sample) {
  std::printf("  %-18s %-5s %20s %12s %10s %9s %12s %10s %7s\n", "axis", "unit", "travel",
              "effort limit", "resolution", "delay, ms", "watchdog, ms", "position", "temp, C");
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const wh_axis& a = axes[i];
    const bool turns = a.kind == WH_ROTATION;
    const bool measured = (sample.valid >> i & 1U) != 0;
    const std::string effort = a.effort_meaning == WH_EFFORT
                                   ? fmt::format("{:.4g} {}", a.effort_limit, turns ? "N·m" : "N")
                                   : effortName(a.effort_meaning);
    std::printf("  %-18s %-5s %20s %12s %10.3g %9.3g %12.3g %10s %7s\n", a.name,
                turns ? "rad" : "m", fmt::format("{:.4g} .. {:.4g}", a.lower, a.upper).c_str(),
                effort.c_str(), a.resolution, 1e3 * a.delay_s, 1e3 * a.silence_s,
                measured ? orDash(sample.position[i], "{:.5g}").c_str() : "-",
                orDash(sample.temperature_c[i], "{:.0f}").c_str());
  }
}

// What `run` would refuse.
Diagnostics misfits(const std::shared_ptr<PluginDriver>& driver, const std::string& device_file) {
  if (device_file.empty()) return {};
  const auto model = loadDeviceFile(device_file);
  if (!model) return model.errors();
  const auto device = PluginDevice::make(driver, *model, kPeriod_s);
  return device ? Diagnostics{} : device.errors();
}

}  // namespace

int deviceInspectCommand(const DeviceOptions& options) {
  const auto say = [](const std::string& line) {
    std::printf("%s\n", printable(line, 1000).c_str());
  };
  const auto facts = pluginFacts(options.driver.path);
  if (!facts) return refuse(facts.errors());
  const auto loaded = PluginDriver::load(options.driver, say, CalledBy::kHost);
  if (!loaded) return refuse(loaded.errors());
  PluginDriver& driver = **loaded;
  wh_sample sample{};
  const int result = driver.read(sample);
  const std::string status = result < 0 ? "gives no sample" : statusText(sample);
  std::printf("%s: %zu axes, boundary %d.%d, for %s; %s\n", printable(facts->name).c_str(),
              driver.axes().size(), facts->major, facts->minor,
              facts->never_waits ? "run --driver and device-host" : "device-host (it may wait)",
              status.c_str());
  printAxes(driver.axes(), sample);
  const Diagnostics errors = misfits(*loaded, options.device);
  Json json{{"driver", facts->name},
            {"file", options.driver.path},
            {"never_waits", facts->never_waits},
            {"status", status},
            {"vendor_code", sample.vendor_code},
            {"axes", Json::array()},
            {"refused", Json::array()}};
  for (std::size_t i = 0; i < driver.axes().size(); ++i) {
    json["axes"].push_back(axisJson(driver.axes()[i], sample, i));
  }
  for (const Diagnostic& error : errors) json["refused"].push_back(format(error));
  if (const int code = writeJson(options.json, json); code != kExitDone) return code;
  if (!errors.empty()) return refuse(errors);
  if (!options.device.empty()) std::printf("fits %s\n", printable(options.device).c_str());
  return kExitDone;
}

}  // namespace wholehand
