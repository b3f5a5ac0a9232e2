#include "play_command.hpp"

#include "assembly/run.hpp"
#include "assembly/text_file.hpp"
#include "device/plugin/plugin_device.hpp"
#include "exit_code.hpp"
#include "git_version.hpp"
#include "report_command.hpp"
#include "resting_player.hpp"
#include "run_text.hpp"
#include "runtime/interrupt_scope.hpp"
#include "server/server.hpp"
#include "server/udp_bridge.hpp"
#include "shipped_files.hpp"
#include "station/report_child.hpp"
#include "station/station.hpp"
#include "status_line.hpp"
#include "summary_json.hpp"

#include <fmt/format.h>

#include <arpa/inet.h>
#include <array>
#include <cstdio>
#include <memory>

namespace wholehand {
namespace {

constexpr const char* kRecordings = "out/recordings";

StationConfig stationConfig(const RunOptions& options, Terminal& terminal, ReportChild& reports) {
  StationConfig config;
  config.files = options.files;
  config.rig.period_s = 1.0 / options.rate_hz;
  config.rig.engine = options.engine;
  config.rig.uncertified = options.uncertified;
  config.rehearse = !options.no_rehearsal;
  config.seed = options.seed;
  config.config_folder = shippedFile("config");
  config.recordings_folder = kRecordings;
  config.record = options.record;
  config.program_version = WHOLEHAND_VERSION;
  config.make_player = restingOrPlaying;
  config.make_report = [&reports](const std::string& recording, const std::string& folder) {
    return reports.make(recording, folder);
  };
  config.log = [&terminal](const std::string& text) { terminal.say(text); };
  config.status = [&terminal](RunState state, const TickSummary& now) {
    const bool runs = state == RunState::kRendering || state == RunState::kRampingDown;
    if (!runs || now.time_s <= 0.0) return;
    terminal.update(now, static_cast<double>(now.records) / now.time_s);
  };
  return config;
}

// A real device: a person holds it, so a person asks for the first force. None: null.
Expected<std::shared_ptr<PluginDriver>> useDriver(RunOptions& options, StationConfig& config,
                                                  Terminal& terminal) {
  if (options.driver.path.empty()) return std::shared_ptr<PluginDriver>();
  auto driver = PluginDriver::load(options.driver,
                                   [&terminal](const std::string& line) { terminal.say(line); });
  if (!driver) return driver;
  options.wait = true;
  config.make_device = [driver = *driver,
                        period_s = config.rig.period_s](const DeviceModel& model) {
    return PluginDevice::make(driver, model, period_s);
  };
  return driver;
}

// What does not fit is said before any page opens.
Expected<Done> checkDriver(const std::shared_ptr<PluginDriver>& driver, const DeviceModel& model,
                           double period_s) {
  if (!driver) return Done{};
  auto fits = PluginDevice::make(driver, model, period_s);
  if (!fits) return fits.errors();
  return Done{};
}

ServerOptions serverOptions(const RunOptions& options,
                            const std::function<void(const std::string&)>& log) {
  ServerOptions server;
  server.address = options.address;
  server.port = static_cast<std::uint16_t>(options.port);
  server.web_folder = shippedFile("web/dist");
  server.token = options.token;
  server.allowed_origins = options.origins;
  server.log = log;
  return server;
}

// Names the option that a fault of the bridge came from.
Diagnostics ofOption(Diagnostics errors, const char* option, const std::string& value) {
  for (Diagnostic& error : errors) {
    const bool token = error.key.find("token") != std::string::npos;
    error.key = token ? "--token" : option;
    error.value = token ? "" : value;
  }
  return errors;
}

// "8091" is a port of this machine, "10.0.0.2:8091" one that others reach.
Expected<UdpOptions> udpOptions(const RunOptions& options) {
  UdpOptions udp;
  udp.token = options.token;
  const bool bare = options.udp.find_first_not_of("0123456789") == std::string::npos;
  auto local = parseUdpEndpoint(bare ? "127.0.0.1:" + options.udp : options.udp);
  if (!local) return ofOption(local.errors(), "--udp", options.udp);
  udp.local = *local;
  for (const std::string& text : options.udp_peers) {
    auto peer = parseUdpEndpoint(text);
    if (!peer) return ofOption(peer.errors(), "--udp-peer", text);
    udp.peers.push_back(*peer);
  }
  return udp;
}

bool isAddress(const std::string& text) {
  std::array<unsigned char, 16> bytes{};
  return inet_pton(AF_INET, text.c_str(), bytes.data()) == 1 ||
         inet_pton(AF_INET6, text.c_str(), bytes.data()) == 1;
}

// Before anything is opened or made.
Diagnostics faultsOf(const RunOptions& options) {
  Diagnostics faults;
  if (!isAddress(options.address)) {
    faults.push_back({"", 0, "--address", options.address, "is no IP address",
                      "127.0.0.1 for this machine alone, 0.0.0.0 for all"});
  }
  for (const std::string& origin : options.origins) {
    if (origin.starts_with("http://") || origin.starts_with("https://")) continue;
    faults.push_back({"", 0, "--origin", origin, "is no origin", "write https://host[:port]"});
  }
  const std::string page = options.report.empty() ? "" : options.report + "/index.html";
  if (auto ready = checkFiles({options.record, options.json, page}); !ready) {
    faults.insert(faults.end(), ready.errors().begin(), ready.errors().end());
  }
  return faults;
}

void printDoors(const RunOptions& options, const Server& server, const UdpBridge& udp) {
  const std::string url = server.url();
  std::printf("%s\n", url.c_str());  // the first line: programs read it
  const char* shown = options.token.empty() ? "" : "?token=<token>";
  std::printf("  game     %s%s\n  console  %sconsole%s\n", url.c_str(), shown, url.c_str(), shown);
  if (!options.token.empty()) {
    std::printf("  others   http://<this machine>:%u/?token=<token>\n",
                static_cast<unsigned>(server.port()));
  }
  if (!options.udp.empty()) std::printf("  udp      %s\n", format(udp.local()).c_str());
}

void printInvitation(const RunOptions& options, const Models& models) {
  printOpening(models);
  if (options.wait) {
    std::printf("  Nothing moves until a page or a game arms. Ctrl-C ends.\n");
  } else if (models.exercise) {
    std::printf(
        "  A virtual patient plays until somebody takes over in the browser. Ctrl-C ends.\n");
  }
}

// The end of a run: what came of the last session, and the files that were asked for.
int conclude(const RunOptions& options, const Models& models, const StationOutcome& outcome) {
  if (!outcome.last) return endOf(false, outcome.interrupted);
  RunOutcome last = *outcome.last;
  last.interrupted = outcome.interrupted;
  const RunSafety safety{outcome.transitions, outcome.rehearsal};
  if (!options.json.empty()) {
    const auto json = summaryJson(models.device, last, safety);
    if (auto done = writeText(options.json, json.dump(2) + "\n"); !done)
      return refuse(done.errors());
  }
  if (!options.report.empty()) {
    const WaitingFor report("the report");
    if (auto done = makeReport(options.record, options.report); !done) return refuse(done.errors());
  }
  printSummary(options, models, last, safety);
  return endOf(last.faulted, last.interrupted);
}

}  // namespace

int playCommand(RunOptions options) {
  if (!options.report.empty() && options.record.empty()) {
    options.record = options.report + "/recording.h5";
  }
  if (Diagnostics faults = faultsOf(options); !faults.empty()) return refuse(faults);
  auto certificate = certificateOf(options);
  if (!certificate) return refuse(certificate.errors());
  const InterruptScope interrupts;  // from the address on, Ctrl-C ends gently
  Terminal terminal;
  ReportChild reports;
  StationConfig config = stationConfig(options, terminal, reports);
  config.rig.certificate = *certificate;
  auto driver = useDriver(options, config, terminal);
  if (!driver) return refuse(driver.errors());
  Station station(std::move(config));
  if (auto loaded = station.load(); !loaded) return refuse(loaded.errors());
  if (auto fits = checkDriver(*driver, station.models().device, 1.0 / options.rate_hz); !fits) {
    return refuse(fits.errors());
  }

  ControlsArbiter controls;
  UdpBridge udp(station, controls);
  ServerOptions server_options =
      serverOptions(options, [&terminal](const std::string& text) { terminal.say(text); });
  server_options.more_metrics = [&udp] { return udpMetricsText(udp.counters()); };
  auto server = Server::open(station, server_options, controls);
  if (!server) return refuse(server.errors());
  if (!options.udp.empty()) {
    auto udp_options = udpOptions(options);
    if (!udp_options) return refuse(udp_options.errors());
    if (auto started = udp.start(*udp_options); !started) {
      return refuse(ofOption(started.errors(), "--udp", options.udp));
    }
    station.addSink([&udp](const TickRecord& record) { udp.publish(record); });
  }
  if (auto ready = prepareFiles({options.record, options.json}); !ready) {
    return refuse(ready.errors());
  }
  station.addSink([&server](const TickRecord& record) { (*server)->publish(record); });
  printDoors(options, **server, udp);
  if (*driver)
    std::printf("  driver   %s, %zu axes\n", (*driver)->name(), (*driver)->axes().size());
  printInvitation(options, station.models());
  terminal.begin(station.models().device);
  Expected<StationOutcome> outcome = station.run(!options.wait, options.duration_s);
  terminal.end();
  {
    const WaitingFor disk("the disk: files that pages have asked for");
    reports.end();
    udp.stop();
    server->reset();
  }
  if (!outcome) return refuse(outcome.errors());
  return conclude(options, station.models(), *outcome);
}

}  // namespace wholehand
