#include "apps/wholehand/report/report_command.hpp"
#include "apps/wholehand/run/clinic_process.hpp"
#include "apps/wholehand/run/run_command.hpp"
#include "apps/wholehand/run/run_summary.hpp"
#include "apps/wholehand/run/status_line.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/pages.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "clinic/presets/presets.hpp"
#include "devices/host/hosted_driver.hpp"
#include "devices/passport/passport.hpp"
#include "devices/plugin/device_driver.hpp"
#include "devices/plugin/plugin_device.hpp"
#include "devices/plugin/transport.hpp"
#include "files/device/device_file.hpp"
#include "files/text/text_file.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "replay/replay_children.hpp"
#include "rig/arming.hpp"
#include "rig/models.hpp"
#include "rig/program_version.hpp"
#include "rig/run/run.hpp"
#include "station/reports.hpp"
#include "station/server/server.hpp"
#include "station/server/udp_bridge.hpp"
#include "station/session_files.hpp"
#include "station/station.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

// Age of a moment [s]; negative: no such moment yet.
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
  out.overdue = facts.overdue;
  return out;
}

// Passport entry in the recording of a device without a passport.
constexpr const char* kWithout = "without";

// Uses the passport. The certificate of a real device is based on it, and it must be valid at every
// arming.
Expected<Done> usePassport(const RunOptions& options, const DeviceDriver& driver,
                           StationConfig& config) {
  if (options.without_passport) {
    config.rig.passport = kWithout;
    return Done{};
  }
  const auto model = loadDeviceFile(options.files.device);
  if (!model) return model.errors();
  const auto checked =
      checkArmingPermit(driver.identity(), *model, 1.0 / config.rig.period_s, placeTimeNow());
  if (!checked) return checked.errors();
  const Passport& passport = checked->passport;
  config.rig.measured = worstCorners(*model, passport, config.rig.period_s);
  config.rig.passport = passport.sha256;
  config.real_time_required = true;
  auto text = readWhole(passport.path);
  if (!text) return text.errors();
  config.rig.passport_text = std::move(*text);
  return Done{};
}

// Permits one enabling with the delay that the device has now, and counts it.
Expected<ArmingPermit> permitNow(DeviceDriver& driver, const DeviceModel& model,
                                 const std::string& armed_with, double period_s) {
  if (armed_with == kWithout) return ArmingPermit::withoutPassport();
  auto checked = checkArmingPermit(driver.identity(), model, 1.0 / period_s, placeTimeNow());
  if (!checked) return checked.errors();
  if (checked->permit.passport() != armed_with) {
    return fileFault(checked->passport.path, "the passport was replaced while this program runs",
                     "start the program again");
  }
  const auto transport = measureTransport(driver, period_s);
  if (!transport) return transport.errors();
  checked->permit.setDelay(delayAtArming(model, checked->passport, *transport, period_s));
  const auto counted = countEnabling(driver.identity(), model, placeTimeNow(), writeText);
  if (!counted) return counted.errors();
  return checked->permit;
}

// Connection to a device: its driver, and the host that holds it, if any.
struct PluggedDevice {
  std::shared_ptr<DeviceDriver> driver;
  std::shared_ptr<HostedDriver> host;  ///< null: the loop calls the driver itself
};

Expected<PluggedDevice> plugIn(const RunOptions& options, Terminal& terminal) {
  if (!options.host.empty()) {
    auto hosted = HostedDriver::connect(options.host);
    if (!hosted) return hosted.errors();
    return PluggedDevice{*hosted, *hosted};
  }
  auto loaded = PluginDriver::load(options.driver,
                                   [&terminal](const std::string& line) { terminal.print(line); });
  if (!loaded) return loaded.errors();
  return PluggedDevice{*loaded, nullptr};
}

DeviceStatus statusOf(const ObservedDriver& driver, const HostedDriver* host) {
  DeviceStatus status = statusOf(driver);
  if (host == nullptr) return status;
  const HostFacts now = host->facts();
  status.hosted = true;
  status.host_age_s = now.sample_age_s;
  status.let_go = host->reason();
  if (host->inSession()) return status;
  // Between two sessions no loop reads: the host says what the drive said last, and when.
  const bool refuses = shouldBeOn(now.phase, now.held) && now.drive != DriveState::kOn;
  status.enabled = (now.status & WH_ENABLED) != 0 && !refuses;
  status.homed = (now.status & WH_HOMED) != 0;
  status.silenced = (now.status & WH_SILENCED) != 0;
  status.sample_age_s = now.drive_heard_s;
  status.overdue = status.overdue || (!host->asks() && now.sample_age_s > kCallWithin_s);
  return status;
}

/// Tells the person at the terminal when the drive behind a host lets go while it should be on, in
/// and between sessions, and when it is on again.
class DriveWatch {
 public:
  DriveWatch(std::shared_ptr<const HostedDriver> host, Terminal& terminal)
      : host_(std::move(host)), terminal_(terminal) {
    if (host_) thread_ = std::thread([this] { watch(); });
  }
  ~DriveWatch() {
    ends_.store(true);
    if (thread_.joinable()) thread_.join();
  }
  DriveWatch(const DriveWatch&) = delete;
  DriveWatch& operator=(const DriveWatch&) = delete;

 private:
  void watch() {
    constexpr std::chrono::milliseconds kEvery{20};
    constexpr double kReportAfter_s = 0.01;  // some drives are on a sample after WH_ENABLE
    for (DriveState told = DriveState::kOn; !ends_.load(); std::this_thread::sleep_for(kEvery)) {
      const HostFacts now = host_->facts();
      if (!shouldBeOn(now.phase, now.held)) {
        told = DriveState::kOn;
      } else if (now.drive != told && now.drive_since_s > kReportAfter_s) {
        told = now.drive;
        terminal_.print(
            fmt::format("{}: the drive {} (heard {:.1f} ms ago){}", host_->where(), describe(told),
                        1e3 * now.drive_heard_s,
                        told == DriveState::kOn ? "" : "; nobody enables it until somebody arms"));
      }
    }
  }

  std::shared_ptr<const HostedDriver> host_;
  Terminal& terminal_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

// Delay of the corners of a passport, in periods; 0 without a passport.
int periodsOf(const std::vector<DeviceModel>& corners) {
  return corners.empty() ? 0 : corners.front().output_delay_ticks;
}

/// Loads the driver or host that the options name, reads its passport, and makes the station open
/// its device at every arming. Because a person holds the device, the first force needs a person's
/// request: options.wait becomes true. Nothing when the options name no driver or host.
Expected<PluggedDevice> useDriver(RunOptions& options, StationConfig& config, Terminal& terminal) {
  if (!isRealDevice(options)) return PluggedDevice{};
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
                        certified = periodsOf(config.rig.measured), &terminal,
                        period_s = config.rig.period_s](
                           const DeviceModel& model) -> Expected<std::unique_ptr<HapticDevice>> {
    // Checked at every arming: a host may have been restarted with another device.
    if (auto found = observed->reconnect(); !found) return found.errors();
    if (plugged.host) {
      if (Diagnostics other = plugged.host->differences(model); !other.empty()) return other;
    }
    auto permit = permitNow(*observed, model, passport, period_s);
    if (!permit) return permit.errors();
    if (const ArmingDelay& delay = permit->delay(); delay.periods > certified) {
      terminal.print(fmt::format("{}: the certificate is computed for {} periods instead of {}",
                                 delay.sentence, delay.periods, certified));
    }
    return PluginDevice::make(observed, model, period_s, std::move(*permit));
  };
  return plugged;
}

/// Prints a prominent warning that the device was not measured.
void warnOfNoPassport(Terminal& terminal) {
  terminal.print("************************************************************");
  terminal.print("WITHOUT PASSPORT: nothing of this device was measured.");
  terminal.print("NOBODY MAY BE ATTACHED TO IT. The recording says so.");
  terminal.print("************************************************************");
}

constexpr const char* kRecordings = "out/recordings";
constexpr const char* kProfiles = "out/profiles";

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
  if (options.clinic.empty()) {
    config.profiles_folder = kProfiles;
  } else {  // the clinic's records decide about the settings
    config.visit_hands_folder = options.clinic + "/hands";
  }
  config.record = options.record;
  config.program_version = programVersion();
  config.make_player = makeMotionPlayer;
  config.make_report = [&reports](const std::string& recording, const std::string& folder) {
    return reports.make(recording, folder);
  };
  config.log = [&terminal](const std::string& text) { terminal.print(text); };
  config.status = [&terminal](RunState state, const TickSummary& now) {
    const bool runs = state == RunState::kRendering || state == RunState::kStopping;
    if (!runs || now.time_s <= 0.0) return;
    terminal.update(now, static_cast<double>(now.records) / now.time_s);
  };
  return config;
}

using MakeDevice = decltype(StationConfig::make_device);

// Reports an unsuitable device, or gains that are not certified with its delay, before any page
// opens.
Expected<Done> checkDevice(const MakeDevice& make_device, const Models& models,
                           const RigOptions& rig) {
  if (!make_device) return Done{};
  auto fits = make_device(models.device);
  if (!fits) return fits.errors();
  auto gains = checkGainsAtArming(models, **fits, rig);
  if (!gains) return gains.errors();
  if (Diagnostics refused = refuseToRender(*gains, rig); !refused.empty()) return refused;
  return Done{};
}

/// Process of the clinic's records; null: not requested. Its token is passed by the environment,
/// not in the list of processes.
Expected<std::unique_ptr<ClinicProcess>> clinicOf(RunOptions& options, Terminal& terminal) {
  if (options.clinic.empty()) return std::unique_ptr<ClinicProcess>();
  auto program = ClinicProcess::findProgram();
  if (!program) return program.errors();
  options.wait = true;
  const std::string token = roleTokens(options.tokens).therapist;
  if (!token.empty()) ::setenv("WHOLEHAND_CLINIC_STATION_TOKEN", token.c_str(), 1);
  return std::make_unique<ClinicProcess>(
      *program,
      ClinicProcess::Options{options.clinic, kRecordings, options.origins,
                             [&terminal](const std::string& line) { terminal.print(line); }});
}

ServerOptions serverOptions(const RunOptions& options,
                            const std::function<void(const std::string&)>& log) {
  ServerOptions server =
      serverOptions(PageOptions{options.address, options.port, options.tokens}, log);
  server.allowed_origins = options.origins;
  return server;
}

// Sets the option's name in errors of the bridge.
Diagnostics ofOption(Diagnostics errors, const char* option, const std::string& value) {
  for (Diagnostic& error : errors) {
    error.key = option;
    error.value = value;
  }
  return errors;
}

// Parses --udp: "8091" is a port for this machine only; "10.0.0.2:8091" is reachable by others.
Expected<UdpOptions> udpOptions(const RunOptions& options) {
  UdpOptions udp;
  const bool bare = options.udp.find_first_not_of("0123456789") == std::string::npos;
  auto local = parseUdpEndpoint(bare ? "127.0.0.1:" + options.udp : options.udp);
  if (!local) return ofOption(local.errors(), "--udp", options.udp);
  udp.local = *local;
  if (!options.udp_key.empty()) {
    const auto key = parseUdpKey(options.udp_key);
    if (!key) return ofOption(key.errors(), "--udp-key", options.udp_key);
    udp.key = *key;
  }
  return udp;
}

bool isAddress(const std::string& text) {
  std::array<unsigned char, 16> bytes{};
  return inet_pton(AF_INET, text.c_str(), bytes.data()) == 1 ||
         inet_pton(AF_INET6, text.c_str(), bytes.data()) == 1;
}

// True for origins such as "http://localhost:5173", pages that this machine serves, as in
// development.
bool isOfThisMachine(const std::string& origin) {
  std::string host = origin.substr(std::min(origin.size(), origin.find("://") + 3));
  host =
      host.starts_with('[') ? host.substr(0, host.find(']') + 1) : host.substr(0, host.find(':'));
  return host == "localhost" || host == "[::1]" || (host.starts_with("127.") && isAddress(host));
}

// Checks the options before anything is opened or created.
Diagnostics faultsOf(const RunOptions& options) {
  Diagnostics faults;
  if (!isAddress(options.address)) {
    faults.push_back(keyFault("", "--address", options.address, "is no IP address",
                              "127.0.0.1 for this machine alone, 0.0.0.0 for all"));
  }
  for (const std::string& origin : options.origins) {
    if (origin.starts_with("http://") || origin.starts_with("https://")) continue;
    faults.push_back({"", 0, "--origin", origin, "is no origin", "write https://host[:port]"});
  }
  const RoleTokens tokens = roleTokens(options.tokens);
  faults.insert(faults.end(), tokens.faults.begin(), tokens.faults.end());
  if (tokens.therapist.empty()) {
    for (const std::string& origin : options.origins) {
      if (isOfThisMachine(origin)) continue;
      faults.push_back({"", 0, "--origin", origin,
                        "would let everybody in who reaches that address: a proxy's visitors all "
                        "come from this machine",
                        "give --token, too"});
    }
  }
  const std::string page = options.report.empty() ? "" : pageIn(options.report);
  if (auto ready = checkFiles({options.record, options.json, page}, inputsOf(options)); !ready) {
    faults.insert(faults.end(), ready.errors().begin(), ready.errors().end());
  }
  return faults;
}

void printAddresses(const RunOptions& options, const Server& server, const UdpBridge& udp) {
  const std::string url = server.url();
  std::printf("%s\n", url.c_str());  // first line, for programs to parse
  const RoleTokens tokens = roleTokens(options.tokens);
  const bool guarded = !tokens.therapist.empty();
  const char* therapist = guarded ? "?token=<token>" : "";
  const char* player = tokens.player.empty() ? therapist : "?token=<the player's token>";
  std::printf("  game     %s%s\n  console  %sconsole%s\n", url.c_str(), player, url.c_str(),
              therapist);
  if (guarded) {
    std::printf("  others   http://<this machine>:%u/?token=<token>\n",
                static_cast<unsigned>(server.port()));
  }
  if (!options.clinic.empty()) std::printf("  clinic   %sclinic%s\n", url.c_str(), therapist);
  if (!options.udp.empty()) std::printf("  udp      %s\n", format(udp.local()).c_str());
}

void printInvitation(const RunOptions& options, const Models& models) {
  printOpening(models, isRealDevice(options));
  if (options.wait) {
    std::printf("  Nothing moves until a page or a game arms. Ctrl-C ends.\n");
  } else if (models.exercise) {
    std::printf(
        "  A virtual patient plays until somebody takes over in the browser. Ctrl-C ends.\n");
  }
}

// Files of each session, under its number: recording, summary and report.
class SessionResults {
 public:
  SessionResults(const RunOptions& options, Terminal& terminal)
      : options_(options), terminal_(terminal) {}

  // Adds a session. Runs while the next session may begin.
  void add(const EndedSession& session, const DeviceModel& device) {
    const std::string json = pathOfSession(options_.json, session.number);
    if (!json.empty()) {
      const RunSafety safety{session.transitions, session.rehearsal};
      const auto summary = summaryJson(device, session.outcome, safety);
      if (auto done = writeText(json, jsonText(summary)); !done) {
        terminal_.print(format(done.errors()));
        failed_ = true;
      }
    }
    if (!options_.report.empty() && session.outcome.written > 0) {
      reports_.push_back({session.record, pathOfSession(options_.report, session.number)});
    }
    terminal_.print(fmt::format("session {}: {:.2f} s{}{}", session.number,
                                session.outcome.summary.time_s,
                                session.outcome.faulted ? ", stopped by a fault" : "",
                                session.outcome.written > 0 ? ", recorded " + session.record : ""));
  }

  // Writes the summary of the last session and the reports of all sessions. @return the program's
  // exit code
  int conclude(const Models& models, const StationOutcome& outcome) {
    if (!outcome.last) return exitCodeOf(false, outcome.interrupted);
    const WaitingFor report("the report");
    for (const auto& [recording, folder] : reports_) {
      if (auto done = makeReport({recording, pageIn(folder)}); !done) {
        refuse(done.errors());
        failed_ = true;
      }
    }
    RunOptions last = options_;
    last.record = outcome.last->outcome.written > 0 ? outcome.last->record : "";
    last.report = pathOfSession(options_.report, outcome.last->number);
    RunOutcome ended = outcome.last->outcome;
    ended.interrupted = outcome.interrupted;
    printSummary(last, models, ended, {outcome.last->transitions, outcome.last->rehearsal});
    if (failed_ && !outcome.faulted) return kExitBadInput;
    return exitCodeOf(outcome.faulted, outcome.interrupted);
  }

 private:
  struct Report {
    std::string recording, folder;
  };
  const RunOptions& options_;
  Terminal& terminal_;
  std::vector<Report> reports_;
  bool failed_ = false;
};

}  // namespace

int playCommand(RunOptions options) {
  if (!options.report.empty() && options.record.empty()) {
    options.record = options.report + "/recording.h5";
  }
  if (Diagnostics faults = faultsOf(options); !faults.empty()) return refuse(faults);
  if (auto pages = checkReportTemplate(); !pages && !options.report.empty()) {
    return refuse(pages.errors());
  }
  auto certificate = certificateOf(options);
  if (!certificate) return refuse(certificate.errors());
  const InterruptScope interrupts;  // from the printing of the address on, Ctrl-C ends the program
                                    // gently
  Terminal terminal;
  ReportChild reports;
  ReplayChildren replays(ReplayChildren::Options{});
  // The station with its clinic and its device.
  StationConfig config = stationConfig(options, terminal, reports);
  config.rig.certificate = *certificate;
  auto clinic = clinicOf(options, terminal);
  if (!clinic) return refuse(clinic.errors());
  if (*clinic) {
    auto presets = clinic::loadPresets(shippedFile("config/clinic/presets.toml"));
    if (!presets) return refuse(presets.errors());
    config.first_parameters = presets->force.front().parameters;  // used while no visit is open
  }
  auto driver = useDriver(options, config, terminal);
  if (!driver) return refuse(driver.errors());
  const DriveWatch drive_watch(driver->host, terminal);
  const MakeDevice make_device = config.make_device;
  const RigOptions rig = config.rig;
  SessionResults results(options, terminal);
  const Station* of = nullptr;
  config.ended = [&](const EndedSession& session) { results.add(session, of->models().device); };
  Station station(std::move(config));
  of = &station;
  if (auto loaded = station.load(); !loaded) return refuse(loaded.errors());
  if (auto fits = checkDevice(make_device, station.models(), rig); !fits) {
    return refuse(fits.errors());
  }

  // The server and the bridge for datagrams.
  ControlHolder controls;
  UdpBridge udp(station, controls);
  ServerOptions server_options =
      serverOptions(options, [&terminal](const std::string& text) { terminal.print(text); });
  server_options.replay = [&replays](const std::string& path, const std::string& question) {
    return replays.answer(path, question);
  };
  server_options.more_metrics = [&udp] { return udpMetricsText(udp.counters()); };
  if (*clinic) server_options.clinic_port = [&records = **clinic] { return records.port(); };
  if (!options.udp.empty()) {
    auto udp_options = udpOptions(options);
    if (!udp_options) return refuse(udp_options.errors());
    if (auto started = udp.start(*udp_options); !started) {
      return refuse(ofOption(started.errors(), "--udp", options.udp));
    }
    server_options.udp = &udp;
  }
  auto server = Server::open(station, server_options, controls);
  if (!server) return refuse(server.errors());
  station.addSink([&udp](const TickRecord& record) { udp.publish(record); });
  if (auto ready = prepareFiles({options.record, options.json}); !ready) {
    return refuse(ready.errors());
  }
  station.addSink([&server](const TickRecord& record) { (*server)->publish(record); });
  // Prints how to reach the program, then runs it.
  printAddresses(options, **server, udp);
  if (*clinic) (*clinic)->start((*server)->port());
  if (driver->driver) {
    const DeviceDriver& plugged = *driver->driver;
    std::printf("  driver   %s, %zu axes%s\n", plugged.name().c_str(), plugged.axes().size(),
                options.host.empty() ? "" : (", in " + plugged.where()).c_str());
  }
  printInvitation(options, station.models());
  if (options.without_passport) warnOfNoPassport(terminal);
  terminal.begin(station.models().device);
  Expected<StationOutcome> outcome = station.run(!options.wait, options.duration_s);
  terminal.end();
  {
    // Ends in this order: the clinic, the child processes, the network.
    const WaitingFor disk("the disk: files that pages have asked for");
    clinic->reset();
    reports.end();
    replays.end();
    udp.stop();
    server->reset();
  }
  if (!outcome) return refuse(outcome.errors());
  return results.conclude(station.models(), *outcome);
}

}  // namespace wholehand
