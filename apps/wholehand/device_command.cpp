#include "device_command.hpp"

#include "core/printable.hpp"
#include "device/host/device_host.hpp"
#include "device/host/host_segment.hpp"
#include "device/plugin/plugin_driver.hpp"
#include "exit_code.hpp"
#include "files/text_file.hpp"
#include "json_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kStandsStill_s = 1.0;
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

std::string stateOf(const HostFacts& host) {
  if (!host.lives) return "gone";
  if (host.sample_age_s < 0.0) return "starts";
  if (host.sample_age_s > kStandsStill_s) return "stands still";
  return describe(host.phase);
}

Json listOneHost(const HostFacts& host) {
  const std::string name = printable(host.name);
  if (!host.problem.empty()) {
    std::printf("  %-20s %s\n", name.c_str(), printable(host.problem, kLongestLine).c_str());
    return {{"name", host.name}, {"problem", host.problem}};
  }
  const bool let_go = host.reason != HostReason::kNone;
  std::printf("  %-20s %-28s %zu axes, process %lld, %s%s\n", name.c_str(),
              printable(host.driver).c_str(), host.axes.size(), static_cast<long long>(host.pid),
              stateOf(host).c_str(), host.in_use ? ", in use" : "");
  if (let_go) std::printf("  %-20s it let go last: %s\n", "", describe(host.reason));
  Json json{{"name", host.name},     {"driver", host.driver}, {"axes", host.axes.size()},
            {"pid", host.pid},       {"lives", host.lives},   {"in_use", host.in_use},
            {"state", stateOf(host)}};
  if (host.sample_age_s >= 0.0) json["sample_age_s"] = host.sample_age_s;
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
  CLI::App* device = app.add_subcommand("device", "Real devices: their drivers and hosts");
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

}  // namespace wholehand
