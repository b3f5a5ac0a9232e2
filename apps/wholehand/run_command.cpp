#include "assembly/kept_black_box.hpp"
#include "assembly/resting_player.hpp"
#include "assembly/rig.hpp"
#include "assembly/run.hpp"
#include "certification/certificate_file.hpp"
#include "core/printable.hpp"
#include "exit_code.hpp"
#include "files/text_file.hpp"
#include "json_text.hpp"
#include "patient/scripted_player.hpp"
#include "report_command.hpp"
#include "run_options.hpp"
#include "run_text.hpp"
#include "runtime/interrupt_scope.hpp"
#include "safety/supervisor.hpp"
#include "server/logs.hpp"
#include "shipped_files.hpp"
#include "status_line.hpp"
#include "summary_json.hpp"
#include "telemetry/disk_room.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

constexpr double kRestAfterMotion_s = 1.0;
constexpr double kRestWithoutMotion_s = 10.0;
constexpr double kExercise_s = 60.0;
constexpr std::chrono::seconds kLogWithin{1};

// Creates the folder at once, so that two runs within one second get separate ones.
std::string folderOfItsOwn() {
  const std::string stem =
      fmt::format("out/run-{:%Y%m%d-%H%M%S}", fmt::localtime(std::chrono::system_clock::now()));
  std::error_code error;  // prepareFiles reports the reason
  fs::create_directories("out", error);
  std::string folder = stem;
  for (int i = 2; !fs::create_directory(folder, error) && !error; ++i) {
    folder = fmt::format("{}-{}", stem, i);
  }
  return folder;
}

// Output files of a run. Checked before the device is armed and created afterwards, so that a
// refused run leaves nothing behind.
class Outputs {
 public:
  explicit Outputs(RunOptions& options)
      : options_(options),
        own_folder_(options.record.empty() && options.report.empty() && options.json.empty()) {
    if (own_folder_) keepAllIn("out/run");  // the name is final once the folder is created
    if (!options.report.empty() && options.record.empty()) {
      options.record = options.report + "/recording.h5";
    }
  }

  [[nodiscard]] Expected<Done> check() {
    if (auto pages = checkReportTemplate(); !pages && !options_.report.empty()) {
      if (!own_folder_) return pages;
      wants_report_ = false;  // not explicitly requested
      options_.report.clear();
      std::fprintf(stderr, "No report: %s\n", format(pages.errors()).c_str());
    }
    return checkFiles(files(), inputsOf(options_));
  }

  [[nodiscard]] Expected<Done> make() {
    if (own_folder_) {
      folder_ = folderOfItsOwn();
      keepAllIn(folder_);
    }
    return prepareFiles(files());
  }

  // Removes the folder of a run that could not begin.
  void unmake() const {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
  }

 private:
  void keepAllIn(const std::string& folder) {
    options_.record = folder + "/recording.h5";
    if (wants_report_) options_.report = folder + "/report";
    options_.json = folder + "/run.json";
  }
  [[nodiscard]] std::vector<std::string> files() const {
    return {options_.record, options_.json, options_.report.empty() ? "" : pageIn(options_.report)};
  }

  RunOptions& options_;
  bool own_folder_;  ///< no output was requested: everything goes into the run's own folder
  bool wants_report_ = true;
  std::string folder_;
};

// Who moves the hand: the exercise's virtual patient, or the motion; with a description.
struct ChosenPlayer {
  std::unique_ptr<Player> player;
  double length_s = 0.0;  // default duration of the run
};

ChosenPlayer chosenPlayer(const Models& models, std::uint64_t seed) {
  ChosenPlayer chosen;
  if (models.exercise) chosen.player = models.exercise->makePlayer(seed);
  chosen.length_s = kExercise_s;
  if (chosen.player) return chosen;
  std::vector<std::string> sentences;
  Intention intention = intentionOf(models, &sentences);
  for (const std::string& sentence : sentences) {
    std::printf("  motion   %s\n", printable(sentence, 1000).c_str());
  }
  chosen.length_s = intention.duration_s() > 0.0 ? intention.duration_s() + kRestAfterMotion_s
                                                 : kRestWithoutMotion_s;
  chosen.player = std::make_unique<ScriptedPlayer>(std::move(intention),
                                                   models.motion ? Mover::kMotion : Mover::kNobody);
  return chosen;
}

void printSetup(const SetupReport& setup) {
  for (const SetupLine& line : setup) {
    if (!line.granted) std::printf("  machine  %s: %s\n", line.what.c_str(), line.sentence.c_str());
  }
}

void sayRoom(const std::string& recording, double period_s, double length_s) {
  if (recording.empty()) return;
  const std::string room = roomNotice(recording, period_s, length_s);
  if (!room.empty()) std::printf("  disk     %s\n", printable(room, 1000).c_str());
}

}  // namespace

std::vector<std::string> inputsOf(const RunOptions& options) {
  std::vector<std::string> inputs = options.files.all();
  inputs.push_back(options.certificate);
  inputs.push_back(options.driver.path);
  return inputs;
}

Expected<std::optional<RigOptions::NamedCertificate>> certificateOf(const RunOptions& options) {
  if (options.certificate.empty()) return std::optional<RigOptions::NamedCertificate>{};
  auto about = readCertificate(options.certificate);
  if (!about) return about.errors();
  return std::optional(RigOptions::NamedCertificate{options.certificate, *about});
}

int runCommand(RunOptions options) {
  auto certificate = certificateOf(options);
  if (!certificate) return refuse(certificate.errors());
  Expected<Models> models = loadModels(options.files);
  if (!models) return refuse(models.errors());

  printOpening(*models);
  ChosenPlayer chosen = chosenPlayer(*models, options.seed);
  const double duration_s = options.duration_s > 0.0 ? options.duration_s : chosen.length_s;

  RigOptions rig_options;
  rig_options.period_s = 1.0 / options.rate_hz;
  rig_options.engine = options.engine;
  rig_options.uncertified = options.uncertified;
  rig_options.certificate = *certificate;
  Outputs outputs(options);
  if (auto writable = outputs.check(); !writable) return refuse(writable.errors());
  sayRoom(options.record, rig_options.period_s, duration_s);
  RunSafety safety;
  if (!options.simulated_clock && !options.no_rehearsal) {
    RehearsalOptions informs;
    informs.fill_pool = false;  // nobody is moved, and no game is connected
    auto rehearsal = rehearse(*models, chosen.player->start(), rig_options, informs);
    if (!rehearsal) return refuse(rehearsal.errors());
    std::printf("  rehearsed %s\n", describe(*rehearsal).c_str());
    safety.rehearsal = std::move(*rehearsal);
  }
  auto rig = buildRig(*models, std::move(chosen.player), rig_options);
  if (!rig) return refuse(rig.errors());
  // What cannot be armed leaves no files.
  if (auto ready = (*rig)->renderer->prepare(); !ready) return refuse(ready.errors());
  if (auto made = outputs.make(); !made) return refuse(made.errors());
  for (const Diagnostic& d : (*rig)->refused) {
    std::printf("  UNCERTIFIED %s\n", format(d).c_str());
  }

  RunPlan plan;
  plan.title = titleOf(*models);
  const long long ticks = std::llround(duration_s * options.rate_hz);
  plan.duration_ticks = static_cast<std::uint64_t>(std::max(1LL, ticks));  // 0 would be endless
  plan.record = options.record;
  plan.black_box = blackBoxPath(options.record);
  plan.simulated_clock = options.simulated_clock;
  plan.seed = options.seed;
  plan.interrupts = &InterruptScope::shared();
  const InterruptScope interrupts;
  Terminal terminal;
  terminal.begin(models->device);
  plan.status = [&](const TickSummary& now, double rate_hz) { terminal.update(now, rate_hz); };
  AsyncLog async_log([&terminal](const std::string& line) { terminal.say(line); });
  plan.notice = [&async_log](const std::string& sentence) { async_log.write(sentence); };
  DeviceModel watched = models->device;
  watched.watch = watchLimits(watched, true);
  SafetyLog log(watched, rig_options.period_s,
                [&async_log](const SafetyTransition& t) { async_log.write(describe(t)); });
  plan.sinks.emplace_back([&log](const TickRecord& record) { log.add(record); });
  Expected<RunOutcome> outcome = runAndRecord(**rig, plan);
  async_log.flush(kLogWithin);
  terminal.end();
  safety.transitions = log.transitions();
  if (!outcome) {
    outputs.unmake();
    return refuse(outcome.errors());
  }
  printSetup(outcome->setup);

  if (!options.json.empty()) {
    const auto json = summaryJson(models->device, *outcome, safety);
    if (auto done = writeText(options.json, jsonText(json)); !done) return refuse(done.errors());
  }
  if (!options.report.empty()) {
    if (auto done = makeReport({options.record, pageIn(options.report)}); !done)
      return refuse(done.errors());
  }
  printSummary(options, *models, *outcome, safety);
  return exitCodeOf(outcome->faulted, outcome->interrupted);
}

}  // namespace wholehand
