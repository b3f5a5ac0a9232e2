#include "assembly/recorded_run.hpp"
#include "assembly/rig.hpp"
#include "assembly/text_file.hpp"
#include "exit_code.hpp"
#include "report_command.hpp"
#include "run_options.hpp"
#include "shipped_files.hpp"
#include "status_line.hpp"
#include "summary_json.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

constexpr double kRestAfterMotion_s = 1.0;
constexpr double kRestWithoutMotion_s = 10.0;

// Made at once, so that of two runs in one second each has its own.
std::string folderOfItsOwn() {
  const std::string stem =
      fmt::format("out/run-{:%Y%m%d-%H%M%S}", fmt::localtime(std::chrono::system_clock::now()));
  std::error_code error;  // prepareFiles says what is wrong
  fs::create_directories("out", error);
  std::string folder = stem;
  for (int i = 2; !fs::create_directory(folder, error) && !error; ++i) {
    folder = fmt::format("{}-{}", stem, i);
  }
  return folder;
}

// With no output asked for, everything is kept in a folder of its own.
void chooseOutputs(RunOptions& options) {
  if (options.record.empty() && options.report.empty() && options.json.empty()) {
    const std::string folder = folderOfItsOwn();
    options.record = folder + "/recording.h5";
    options.report = folder + "/report";
    options.json = folder + "/run.json";
  }
  if (!options.report.empty() && options.record.empty()) {
    options.record = options.report + "/recording.h5";
  }
}

std::string titleOf(const Models& models) {
  if (models.files.motion.empty()) return models.scene.name;
  return models.scene.name + ", " + fs::path(models.files.motion).stem().string();
}

// Where the person starts and what they aim at, told in sentences on the way.
Intention intentionOf(const Models& models) {
  AxisPosition rest(models.device.axisCount());
  for (int a = 0; a < rest.size(); ++a) {
    const DeviceAxis& axis = models.device.axes[a];
    const bool centered = axis.kind == AxisKind::kTranslation || axis.lower < 0.0;
    rest[a] = centered ? 0.5 * (axis.lower + axis.upper) : models.hand.reference[a];
  }
  if (!models.motion) return Intention::throughWaypoints({{0.0, rest}});
  std::vector<std::string> sentences;
  Intention intention =
      Intention::fromMotion(*models.motion, models.patient.motion, models.device, rest, &sentences);
  for (const std::string& sentence : sentences) std::printf("  motion   %s\n", sentence.c_str());
  return intention;
}

void printOpening(const Models& models) {
  std::printf("Wholehand: %s\n", titleOf(models).c_str());
  std::printf("  device   %s, %d axes, simulated; patient %s\n", models.device.name.c_str(),
              models.device.axisCount(), models.patient.name.c_str());
  std::printf("  hand     %s, %d joints, %zu capsules; scene %s, %zu bodies\n",
              models.hand.name.c_str(), models.hand.joint_count, models.hand.capsules.size(),
              models.scene.name.c_str(), models.scene.bodies.size());
}

void printSetup(const SetupReport& setup) {
  for (const SetupLine& line : setup) {
    if (!line.granted) std::printf("  machine  %s: %s\n", line.what.c_str(), line.sentence.c_str());
  }
}

void printSummary(const RunOptions& options, const Models& models, const RunOutcome& outcome) {
  const TickSummary& s = outcome.summary;
  std::printf("\n%s after %.2f s: %llu ticks, %llu deadlines missed\n",
              outcome.faulted       ? "Stopped by a fault"
              : outcome.interrupted ? "Interrupted"
                                    : "Done",
              s.time_s, static_cast<unsigned long long>(s.ticks),
              static_cast<unsigned long long>(s.missed_deadlines));
  std::printf("  tick     %.0f µs CPU at the median, %.0f p99, %.0f p99.9, %.0f at most\n",
              s.cpu.p50_ns / 1e3, s.cpu.p99_ns / 1e3, s.cpu.p999_ns / 1e3, s.cpu.max_ns / 1e3);
  std::printf("  force    largest %s; at most %d contacts at once\n",
              largestEffort(models.device, s.max_effort).c_str(), s.contacts_max);
  std::printf("  faults   %s\n", faultText(s).c_str());
  if (outcome.dropped_records + outcome.dropped_writes > 0) {
    std::printf("  dropped  %llu records: the %s was full\n",
                static_cast<unsigned long long>(outcome.dropped_records + outcome.dropped_writes),
                outcome.dropped_writes > 0 ? "disk" : "queue");
  }
  if (!options.record.empty()) std::printf("  recorded %s\n", options.record.c_str());
  if (!options.report.empty()) std::printf("  report   %s/index.html\n", options.report.c_str());
}

int exitCodeOf(const RunOutcome& outcome) {
  if (outcome.faulted) return kExitFault;
  return outcome.interrupted ? kExitInterrupted : kExitDone;
}

}  // namespace

int runCommand(RunOptions options) {
  Expected<Models> models = loadModels(options.files);
  if (!models) return refuse(models.errors());

  printOpening(*models);
  Intention intention = intentionOf(*models);
  const double length_s = intention.duration_s() > 0.0 ? intention.duration_s() + kRestAfterMotion_s
                                                       : kRestWithoutMotion_s;
  const double duration_s = options.duration_s > 0.0 ? options.duration_s : length_s;

  RigOptions rig_options;
  rig_options.period_s = 1.0 / options.rate_hz;
  rig_options.engine = options.engine;
  rig_options.uncertified = options.uncertified;
  auto rig = buildRig(*models, std::move(intention), rig_options);
  if (!rig) return refuse(rig.errors());
  if (auto armed = (*rig)->renderer->arm(); !armed) return refuse(armed.errors());
  chooseOutputs(options);
  const std::string page = options.report.empty() ? "" : options.report + "/index.html";
  if (auto ready = prepareFiles({options.record, options.json, page}); !ready) {
    return refuse(ready.errors());
  }
  for (const Diagnostic& d : (*rig)->refused) {
    std::printf("  UNCERTIFIED %s\n", format(d).c_str());
  }

  RunPlan plan;
  plan.title = titleOf(*models);
  plan.duration_ticks = static_cast<std::uint64_t>(std::llround(duration_s * options.rate_hz));
  plan.record = options.record;
  plan.simulated_clock = options.simulated_clock;
  StatusLine status(models->device);
  plan.status = [&](const TickSummary& now, double rate_hz) { status.update(now, rate_hz); };
  Expected<RunOutcome> outcome = runAndRecord(**rig, plan);
  status.finish();
  if (!outcome) return refuse(outcome.errors());
  printSetup(outcome->setup);

  if (!options.json.empty()) {
    const auto json = summaryJson(models->device, *outcome);
    if (auto done = writeText(options.json, json.dump(2) + "\n"); !done)
      return refuse(done.errors());
  }
  if (!options.report.empty()) {
    if (auto done = makeReport(options.record, options.report); !done) return refuse(done.errors());
  }
  printSummary(options, *models, *outcome);
  return exitCodeOf(*outcome);
}

}  // namespace wholehand
