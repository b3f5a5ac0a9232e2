#include "apps/tools/device/device_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "apps/wholehand/shared/tools.hpp"
#include "devices/host/device_host.hpp"
#include "devices/host/host_segment.hpp"
#include "devices/plugin/plugin_device.hpp"
#include "devices/plugin/plugin_driver.hpp"
#include "files/device/device_file.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/model/device_model.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <vector>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestLine = 1000;  // characters

std::vector<fs::path> shippedDrivers() {
  std::error_code error;
  std::vector<fs::path> out;
  for (const std::string& folder : shippedDriverFolders()) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
      if (entry.path().extension() == ".so") out.push_back(entry.path());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

Json listDrivers() {
  Json out = Json::array();
  std::printf("drivers beside this program\n");
  for (const fs::path& path : shippedDrivers()) {
    const auto facts = pluginFacts(path.string());
    const std::string name = printable(path.stem().string());
    Json json{{"file", path.string()}};
    if (facts) {
      json["name"] = facts->name;
      json["never_waits"] = facts->never_waits;
      std::printf("  %-20s %-28s %s\n", name.c_str(), printable(facts->name).c_str(),
                  facts->never_waits ? "run --driver, device-host" : "device-host (it may wait)");
    } else {
      json["problem"] = facts.errors().front().problem;
      std::printf("  %-20s %s\n", name.c_str(),
                  printable(facts.errors().front().problem, kLongestLine).c_str());
    }
    out.push_back(json);
  }
  if (out.empty()) std::printf("  none\n");
  return out;
}

Json listOneHost(const HostFacts& host) {
  const std::string name = printable(host.name);
  if (!host.problem.empty()) {
    std::printf("  %-20s %s\n", name.c_str(), printable(host.problem, kLongestLine).c_str());
    return {{"name", host.name}, {"problem", host.problem}};
  }
  const bool let_go = host.reason != ReleaseReason::kNone;
  std::printf("  %-20s %-28s %zu axes, process %lld, %s%s\n", name.c_str(),
              printable(host.driver).c_str(), host.axes.size(), static_cast<long long>(host.pid),
              stateOf(host).c_str(), host.in_use ? ", in use" : "");
  const bool heard = host.lives && host.drive_heard_s >= 0.0;
  if (heard) {
    std::printf("  %-20s its drive %s, for %.1f s (heard %.1f ms ago)\n", "", describe(host.drive),
                host.drive_since_s, host.drive_heard_s * 1e3);
  }
  if (let_go) std::printf("  %-20s it let go last: %s\n", "", describe(host.reason));
  Json json{{"name", host.name},     {"driver", host.driver}, {"axes", host.axes.size()},
            {"pid", host.pid},       {"lives", host.lives},   {"in_use", host.in_use},
            {"state", stateOf(host)}};
  if (host.sample_age_s >= 0.0) json["sample_age_s"] = host.sample_age_s;
  if (heard) {
    json["drive"] = {{"on", host.drive == DriveState::kOn},
                     {"state", describe(host.drive)},
                     {"since_s", host.drive_since_s},
                     {"heard_s", host.drive_heard_s}};
  }
  if (let_go) json["let_go"] = describe(host.reason);
  return json;
}

void addDriverOptions(CLI::App& command, DriverLocation& driver) {
  command.add_option("--driver", driver.path, "Driver of the device (docs/drivers.md), .so")
      ->required();
  command.add_option("--device-at", driver.locator,
                     "Which device, as the driver names it: a serial number, a port ...");
  command.add_option("--driver-settings", driver.settings, "The driver's own settings");
}

void addConform(CLI::App& device, DeviceOptions& o, int& code) {
  CLI::App* conform =
      device.add_subcommand("conform", "Check a driver against the rules of device.h, one by one");
  addDriverOptions(*conform, o.driver);
  conform->add_option("--only", o.conformance.only, "Checks whose names begin with this");
  CLI::Option* effort = conform->add_flag(
      "--allow-effort", o.conformance.allow_effort,
      "Enable the device and send up to 20 % of its limits. NOBODY MAY BE ATTACHED");
  conform
      ->add_flag("--allow-beyond-limit", o.conformance.allow_beyond_limit,
                 "Also ask for 1.5 times the limit for 5 ms, which a good drive clips")
      ->needs(effort);
  conform->add_option("--device", o.device,
                      "Device file: its masses and neutral efforts are used, too");
  conform->add_option("--json", o.json, "Write the findings to this file");
  conform->footer(
      "Exit code 0: no check failed; 1: one did; 2: the arguments are wrong.\n"
      "Without --allow-effort nothing is enabled and nothing moves.");
  conform->callback([&o, &code] { code = deviceConformCommand(o); });
}

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

// Faults for which `run` would refuse the device.
Diagnostics misfits(const std::shared_ptr<PluginDriver>& driver, const std::string& device_file) {
  if (device_file.empty()) return {};
  const auto model = loadDeviceFile(device_file);
  if (!model) return model.errors();
  const auto device = PluginDevice::make(driver, *model, kPeriod_s);
  return device ? Diagnostics{} : device.errors();
}

const char* word(Outcome outcome) {
  switch (outcome) {
    case Outcome::kPassed:
      return "passed";
    case Outcome::kFailed:
      return "failed";
    case Outcome::kSkipped:
      return "not run";
  }
  return "";
}

struct Counts {
  int passed = 0, failed = 0, not_run = 0;
};
Counts count(const std::vector<CheckResult>& results) {
  Counts out;
  for (const CheckResult& r : results) {
    if (r.finding.outcome == Outcome::kPassed) ++out.passed;
    if (r.finding.outcome == Outcome::kFailed) ++out.failed;
    if (r.finding.outcome == Outcome::kSkipped) ++out.not_run;
  }
  return out;
}

// True for checks that need the person's permission and did not get it; reported once for all of
// them.
bool isLeftOut(const Check& check, const ConformanceOptions& asked) {
  return (check.effect != Effect::kLooks && !asked.allow_effort) ||
         (check.effect == Effect::kOverreaches && !asked.allow_beyond_limit);
}

void print(const CheckResult& r) {
  const char* const mark = r.finding.outcome == Outcome::kPassed   ? "ok  "
                           : r.finding.outcome == Outcome::kFailed ? "FAIL"
                                                                   : "-   ";
  std::printf("%s %-31s %s\n", mark, r.check->id, r.check->asks);
  if (r.finding.outcome == Outcome::kPassed) return;
  std::printf("     %s\n", printable(r.finding.text, 1000).c_str());
  if (r.finding.outcome == Outcome::kFailed) std::printf("     → %s\n", r.check->remedy);
}

Json jsonOf(const DeviceOptions& options, const std::vector<CheckResult>& results) {
  const Counts counts = count(results);
  Json json{{"driver", options.driver.path},
            {"allow_effort", options.conformance.allow_effort},
            {"allow_beyond_limit", options.conformance.allow_beyond_limit},
            {"passed", counts.passed},
            {"failed", counts.failed},
            {"not_run", counts.not_run},
            {"checks", Json::array()}};
  for (const CheckResult& r : results) {
    Json check{{"id", r.check->id},
               {"asks", r.check->asks},
               {"outcome", word(r.finding.outcome)},
               {"finding", r.finding.text}};
    if (r.finding.outcome == Outcome::kFailed) check["remedy"] = r.check->remedy;
    json["checks"].push_back(check);
  }
  return json;
}

}  // namespace

int deviceListCommand(const DeviceOptions& options) {
  Json json;
  json["drivers"] = listDrivers();
  json["hosts"] = Json::array();
  std::printf("hosts of this machine\n");
  for (const HostFacts& host : listHosts()) json["hosts"].push_back(listOneHost(host));
  if (json["hosts"].empty()) std::printf("  none\n");
  return writeJson(options.json, json);
}

int writeJson(const std::string& path, const Json& json) {
  if (path.empty()) return kExitDone;
  const auto written = writeText(path, jsonText(json));
  return written ? kExitDone : refuse(written.errors());
}

void addDevice(CLI::App& app, DeviceOptions& o, int& code) {
  CLI::App* device = app.add_subcommand("device", toolHelp("device"));
  device->require_subcommand(1);
  CLI::App* list = device->add_subcommand(
      "list", "Drivers that ship with the program, and hosts that run on this machine");
  list->add_option("--json", o.json, "Write the list to this file");
  list->callback([&o, &code] { code = deviceListCommand(o); });
  CLI::App* inspect = device->add_subcommand(
      "inspect", "Open a device, without enabling it, and show its axes and one sample");
  addDriverOptions(*inspect, o.driver);
  inspect->add_option("--device", o.device,
                      "Device file to compare the driver with, as `run` does");
  inspect->add_option("--json", o.json, "Write what was found to this file");
  inspect->footer("Exit code 0: opened, and the device file fits; 2: not.");
  inspect->callback([&o, &code] { code = deviceInspectCommand(o); });
  addConform(*device, o, code);
  addCommission(*device, o.commission, code);
}

int deviceInspectCommand(const DeviceOptions& options) {
  const auto print_line = [](const std::string& line) {
    std::printf("%s\n", printable(line, 1000).c_str());
  };
  const auto facts = pluginFacts(options.driver.path);
  if (!facts) return refuse(facts.errors());
  const auto loaded = PluginDriver::load(options.driver, print_line, CalledBy::kHost);
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

int deviceConformCommand(const DeviceOptions& options) {
  const auto no = [](const char* key, const std::string& value, const char* why,
                     const char* remedy) {
    return refuse({Diagnostic{"", 0, key, value, why, remedy}});
  };
  std::error_code error;
  if (!std::filesystem::is_regular_file(options.driver.path, error)) {
    return no("--driver", options.driver.path, "is no file",
              "give the path of a driver's shared object");
  }
  // Adds mass and weight of the axes from the device file.
  ConformanceOptions asked = options.conformance;
  asked.driver = options.driver;
  if (!options.device.empty()) {
    const auto model = loadDeviceFile(options.device);
    if (!model) return refuse(model.errors());
    for (const DeviceAxis& axis : model->axes) {
      asked.known.push_back({std::string(axis.name), axis.mass, axis.neutral_effort});
    }
  }
  const auto began = std::chrono::steady_clock::now();
  const std::vector<CheckResult> results = conform(asked);
  if (results.empty()) {
    return no("--only", asked.only, "is the beginning of no check",
              "run without it to see their names");
  }
  // Prints the results, and the number of checks that were not permitted.
  std::size_t left_out = 0;
  for (const CheckResult& r : results) {
    if (isLeftOut(*r.check, asked)) {
      ++left_out;
    } else {
      print(r);
    }
  }
  if (left_out > 0) {
    std::printf(
        "-    %zu checks that move the device were left out: %s\n", left_out,
        asked.allow_effort ? "--allow-beyond-limit" : "--allow-effort, with nobody attached");
  }
  const Counts counts = count(results);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  std::printf("%zu checks in %.0f s: %d passed, %d failed, %d not run\n", results.size(),
              took.count(), counts.passed, counts.failed, counts.not_run);
  if (const int code = writeJson(options.json, jsonOf(options, results)); code != kExitDone) {
    return code;
  }
  return counts.failed == 0 ? kExitDone : kExitNotFit;
}

}  // namespace wholehand
