#include "play_command.hpp"

#include "assembly/text_file.hpp"
#include "exit_code.hpp"
#include "git_version.hpp"
#include "report_command.hpp"
#include "resting_player.hpp"
#include "server/server.hpp"
#include "server/udp_bridge.hpp"
#include "shipped_files.hpp"
#include "station/station.hpp"
#include "status_line.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <spawn.h>
#include <sys/wait.h>

extern char** environ;  // NOLINT(readability-identifier-naming): POSIX

namespace wholehand {
namespace fs = std::filesystem;
namespace {

constexpr const char* kRecordings = "out/recordings";

// In a process of its own: HDF5 may be writing in this one, and a page takes seconds of both cores.
Expected<Done> makeReportAside(const std::string& recording, const std::string& folder) {
  const auto refusal = [&](std::string problem) {
    return Diagnostic{recording,
                      0,
                      "",
                      "",
                      std::move(problem),
                      "try: wholehand report " + recording + " --out " + folder};
  };
  std::string program = "/proc/self/exe", verb = "report", in = recording, flag = "--out",
              out = folder;
  char* arguments[] = {program.data(), verb.data(), in.data(), flag.data(), out.data(), nullptr};
  pid_t child = 0;
  if (const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments, environ);
      error != 0) {
    return refusal(std::string("no report could be made: ") + std::strerror(error));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return refusal("no report could be made");
  return Done{};
}

std::string titleOf(const Models& models) {
  if (!models.exercise) return models.scene.name;
  const ExerciseDescription& exercise = models.exercise->description();
  return fmt::format("{}, level {} of {}", exercise.name, exercise.level, exercise.levels);
}

StationConfig stationConfig(const RunOptions& options, StatusLine*& line) {
  StationConfig config;
  config.files = options.files;
  config.rig.period_s = 1.0 / options.rate_hz;
  config.rig.engine = options.engine;
  config.rig.uncertified = options.uncertified;
  config.seed = options.seed;
  config.config_folder = shippedFile("config");
  config.recordings_folder = kRecordings;
  config.record = options.record;
  config.program_version = WHOLEHAND_VERSION;
  config.make_player = restingOrPlaying;
  config.make_report = makeReportAside;
  config.log = [&line](const std::string& text) {
    if (line != nullptr) line->finish();
    std::printf("  %s\n", text.c_str());
  };
  config.status = [&line](RunState state, const TickSummary& now) {
    const bool runs = state == RunState::kRendering || state == RunState::kRampingDown;
    if (line != nullptr && runs && now.time_s > 0.0)
      line->update(now, static_cast<double>(now.records) / now.time_s);
  };
  return config;
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

// "8091" is a port of this machine, "10.0.0.2:8091" one that others reach.
Expected<UdpOptions> udpOptions(const RunOptions& options) {
  UdpOptions udp;
  udp.token = options.token;
  const bool bare = options.udp.find_first_not_of("0123456789") == std::string::npos;
  auto local = parseUdpEndpoint(bare ? "127.0.0.1:" + options.udp : options.udp);
  if (!local) return local.errors();
  udp.local = *local;
  for (const std::string& text : options.udp_peers) {
    auto peer = parseUdpEndpoint(text);
    if (!peer) return peer.errors();
    udp.peers.push_back(*peer);
  }
  return udp;
}

void printOpening(const Models& models, const std::string& url) {
  std::printf("%s\n", url.c_str());  // the first line: programs read it
  std::printf("  game     %s\n  console  %sconsole\n", url.c_str(), url.c_str());
  std::printf("Wholehand: %s\n", titleOf(models).c_str());
  std::printf("  device   %s, %d axes, simulated; patient %s\n", models.device.name.c_str(),
              models.device.axisCount(), models.patient.name.c_str());
  std::printf("  hand     %s, %d joints, %zu capsules\n", models.hand.name.c_str(),
              models.hand.joint_count, models.hand.capsules.size());
  std::printf("  A virtual patient plays until somebody takes over in the browser. Ctrl-C ends.\n");
}

// What --report and --json ask for, of the first session.
Expected<Done> makeReportOf(const RunOptions& options) {
  if (options.report.empty() || options.record.empty()) return Done{};
  return makeReport(options.record, options.report);
}

}  // namespace

int playCommand(RunOptions options) {
  if (!options.report.empty() && options.record.empty()) {
    options.record = options.report + "/recording.h5";
  }
  StatusLine* line = nullptr;
  Station station(stationConfig(options, line));
  if (auto loaded = station.load(); !loaded) return refuse(loaded.errors());
  if (auto ready = prepareFiles({options.record}); !ready) return refuse(ready.errors());
  const auto log = [&line](const std::string& text) {
    if (line != nullptr) line->finish();
    std::printf("  %s\n", text.c_str());
  };
  ControlsArbiter controls;
  UdpBridge udp(station, controls);
  ServerOptions server_options = serverOptions(options, log);
  server_options.more_metrics = [&udp] { return udpMetricsText(udp.counters()); };
  auto server = Server::open(station, server_options, controls);
  if (!server) return refuse(server.errors());
  if (!options.udp.empty()) {
    auto udp_options = udpOptions(options);
    if (!udp_options) return refuse(udp_options.errors());
    if (auto started = udp.start(*udp_options); !started) return refuse(started.errors());
    station.addSink([&udp](const TickRecord& record) { udp.publish(record); });
  }
  station.addSink([&server](const TickRecord& record) { (*server)->publish(record); });
  printOpening(station.models(), (*server)->url());
  if (!options.udp.empty()) std::printf("  udp      %s\n", format(udp.local()).c_str());
  StatusLine status(station.models().device);
  line = &status;
  Expected<StationOutcome> outcome = station.run(!options.wait, options.duration_s);
  status.finish();
  line = nullptr;
  udp.stop();
  server->reset();
  if (!outcome) return refuse(outcome.errors());
  if (auto made = makeReportOf(options); !made) return refuse(made.errors());
  return endOf(outcome->faulted, outcome->interrupted && options.duration_s > 0.0);
}

}  // namespace wholehand
