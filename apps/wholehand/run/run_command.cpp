#include "apps/wholehand/run/run_command.hpp"

#include "apps/wholehand/report/report_command.hpp"
#include "apps/wholehand/run/run_summary.hpp"
#include "apps/wholehand/run/status_line.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/options.hpp"
#include "apps/wholehand/shared/pages.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "certify/certificate_file.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/patient/motion.hpp"
#include "loop/psychometrics/answer_log.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "loop/safety/supervisor.hpp"
#include "record/disk_reserve.hpp"
#include "replay/compared_answers.hpp"
#include "rig/models.hpp"
#include "rig/rig.hpp"
#include "rig/run/run.hpp"
#include "station/server/logs.hpp"

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

// Chooses the cocktail bar if no exercise is named.
void chooseExercise(RunOptions& o) {
  o.files.motion.clear();
  o.files.exercise = exerciseFile(o.files.exercise.empty() ? "cocktail-bar" : o.files.exercise);
}

const char* deviceOption(const RunOptions& o) {
  return o.host.empty() ? "--driver" : "--host";
}

// Faults for options that would have no effect.
Diagnostics mismatched(const CLI::App& run, const RunOptions& o, bool scene, bool pages) {
  Diagnostics faults;
  if (scene && run.count("--exercise") > 0) {
    faults.push_back(keyFault("", "--exercise", o.files.exercise,
                              "cannot go with --scene or --motion: it names its own scene",
                              "leave one of them out"));
  }
  if (scene && run.count("--level") > 0) {
    faults.push_back(keyFault("", "--level", std::to_string(o.files.level),
                              "belongs to an exercise, not to a scene", "leave one of them out"));
  }
  for (const char* option : {"--port", "--address", "--token", "--token-file", "--origin",
                             "--clinic", "--udp", "--udp-key", "--wait"}) {
    if (pages || run.count(option) == 0) continue;
    faults.push_back(keyFault(
        "", option, "", "is about pages and games, and this run opens no port",
        scene && !o.no_web && !o.simulated_clock ? "give --port, too, or leave it out"
                                                 : "leave out --no-web and --simulated-clock"));
  }
  if (o.no_rehearsal && o.simulated_clock) {
    faults.push_back(keyFault("", "--no-rehearsal", "", "is about real time: there is none",
                              "leave out --no-rehearsal or --simulated-clock"));
  }
  for (const char* simulated : {"--no-rehearsal", "--uncertified", "--simulated-clock"}) {
    if (!isRealDevice(o) || run.count(simulated) == 0) continue;
    faults.push_back(keyFault(
        "", simulated, "",
        std::string("is for simulated devices, and ") + deviceOption(o) + " names a real one",
        "leave one of them out"));
  }
  if (o.without_passport && !isRealDevice(o)) {
    faults.push_back({"", 0, "--without-passport", "", "is about a real device, and none is named",
                      "leave it out, or give --driver or --host"});
  }
  if (isRealDevice(o) && !pages) {
    faults.push_back(keyFault("", deviceOption(o), o.host.empty() ? o.driver.path : o.host,
                              "needs the console: a person arms and stops",
                              "leave out --no-web, --scene and --motion"));
  }
  if (run.count("--udp-key") > 0 && run.count("--udp") == 0) {
    faults.push_back({"", 0, "--udp-key", "", "needs the port that it opens", "give --udp, too"});
  }
  return faults;
}

void addPages(CLI::App& run, RunOptions& o) {
  run.add_option("--port", o.port, "Port of the pages; 0: any free one")
      ->check(wholeBetween(0, 65535))
      ->capture_default_str();
  run.add_option("--address", o.address,
                 "Address to listen at; any that other machines can reach needs --token")
      ->capture_default_str();
  run.add_option("--token", o.tokens,
                 "Secret that clients must show, at least 16 characters; for one role only: "
                 "therapist=..., player=..., watcher=... (others read it in the list of processes: "
                 "prefer --token-file)");
  run.add_option("--token-file", o.token_file,
                 "File with a token on each line, as for --token (default: those of the variable "
                 "WHOLEHAND_TOKEN, separated by commas)");
  run.add_option("--origin", o.origins, "Pages of other origins that may connect");
  run.add_option("--udp", o.udp,
                 "Port for game engines, or address:port; 0: any port (default: closed)");
  run.add_option("--udp-key", o.udp_key,
                 "Key of a game or microcontroller that speaks UDP only: 16 hexadecimal digits");
  run.add_flag("--no-web", o.no_web, "Open no port");
  run.add_flag("--wait", o.wait, "Arm only when a client asks for it");
  run.add_option("--clinic", o.clinic,
                 "Folder of a clinic's patients and visits (docs/clinic.md); implies --wait");
}

constexpr double kRestAfterMotion_s = 1.0;
constexpr double kRestWithoutMotion_s = 10.0;
constexpr double kExercise_s = 60.0;
constexpr std::chrono::seconds kLogWithin{1};

// Creates the run's own folder at once, so that two runs within one second get separate ones.
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
    if (own_folder_) keepAllIn("out/run");  // preliminary name; the folder is created later
    if (!options.report.empty() && options.record.empty()) {
      options.record = options.report + "/recording.h5";
    }
  }

  [[nodiscard]] Expected<Done> check() {
    if (auto pages = checkReportTemplate(); !pages && !options_.report.empty()) {
      if (!own_folder_) return pages;
      wants_report_ = false;  // it was not explicitly requested
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
  bool own_folder_;  ///< no output file was requested, so all go into the run's own folder
  bool wants_report_ = true;
  std::string folder_;
};

// The player that moves the hand: the exercise's virtual patient or the motion, with a description.
struct ChosenPlayer {
  std::unique_ptr<Player> player;
  double length_s = 0.0;  // default duration of the run
};

ChosenPlayer chosenPlayer(const Models& models, std::uint64_t seed) {
  ChosenPlayer chosen;
  chosen.player = makeExercisePlayer(models, seed);
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

void printDiskRoom(const std::string& recording, double period_s, double length_s) {
  if (recording.empty()) return;
  const std::string room = roomNotice(recording, period_s, length_s);
  if (!room.empty()) std::printf("  disk     %s\n", printable(room, 1000).c_str());
}

// The answers of the exercise, if it compares.
AnswerLog answerLogOf(const Models& models) {
  if (!models.exercise) return {{}, {}};
  const ExerciseDescription& exercise = models.exercise->description();
  return {exercise.value_names, exercise.event_names};
}

// Adds the threshold, or what is missing for it, to the results of the exercise.
void addThreshold(const nlohmann::json& compared, std::vector<ResultValue>& results) {
  if (!compared.is_object()) return;
  std::string text = comparedText(compared);
  for (const ComparedFigure& figure : comparedFigures(compared)) {
    results.push_back({figure.name, figure.value, std::exchange(text, "")});
  }
  if (!text.empty()) {
    results.push_back({"answers_missing", compared["missing_answers"], std::move(text)});
  }
}

}  // namespace

RunOptions shippedRun() {
  RunOptions run;
  run.files.scene = shippedFile("config/scenes/four-shapes.toml");
  run.files.hand = shippedFile("config/hands/adult-median-right.toml");
  run.files.device = shippedFile("config/devices/lambda-pride.toml");
  run.files.rendering.clear();
  run.files.patient = shippedFile("config/patients/relaxed-adult.toml");
  run.files.motion = shippedFile("data/human-motion/reach-grasp-00.csv");
  return run;
}

void addRun(CLI::App& app, RunOptions& options, int& code) {
  RunOptions& o = options;
  CLI::App* run = app.add_subcommand(
      "run", "Run an exercise with its pages (the cocktail bar), or play a recorded motion");
  run->add_option("--exercise", o.files.exercise,
                  "Exercise: a name (cocktail-bar, the default; free-grasping ...) or a file");
  run->add_option("--level", o.files.level, "Level of the exercise")
      ->check(wholeBetween(1, 1000))
      ->capture_default_str();
  run->add_option("--seed", o.seed, "Seed of the virtual patient")
      ->check(wholeNumber())
      ->capture_default_str();
  run->add_option("--scene", o.files.scene, "Scene file, without exercise: free grasping")
      ->capture_default_str();
  addHandAndDevice(*run, o.files.hand, o.files.device, o.files.rendering);
  CLI::Option* driver = run->add_option(
      "--driver", o.driver.path, "Driver of a real device (docs/drivers.md): a name or a path");
  run->add_option("--device-at", o.driver.locator,
                  "Which device, as the driver names it: a serial number, a port ...")
      ->needs(driver);
  run->add_option("--driver-settings", o.driver.settings, "The driver's own settings")
      ->needs(driver);
  run->add_option("--host", o.host, "Name of the `wholehand device-host` that holds a real device")
      ->excludes(driver);
  run->add_flag("--without-passport", o.without_passport,
                "Take a real device that was not commissioned; NOBODY MAY BE ATTACHED (recorded)");
  run->add_option("--patient", o.files.patient, "Virtual patient file")->capture_default_str();
  run->add_option(
      "--prescription", o.files.prescription,
      "Limits of one person as walls, and a corridor to each goal (docs/prescription.md)");
  run->add_option("--motion", o.files.motion, "Recorded motion to play in the scene, CSV")
      ->capture_default_str();
  addEngine(*run, o.engine);
  addRate(*run, o.rate_hz);
  run->add_option("--duration", o.duration_s,
                  "Length of the run (default: the motion's and 1 s of rest; with pages endless)")
      ->check(finiteBetween(0.001, 86400.0, "s"));
  run->add_option("--record", o.record, "Write every tick to this HDF5 file");
  run->add_option("--report", o.report, "Write the report into this folder");
  run->add_option("--json", o.json, "Write the summary to this file");
  run->add_flag("--simulated-clock", o.simulated_clock,
                "Run as fast as possible, not in real time");
  run->add_flag("--no-rehearsal", o.no_rehearsal,
                "Arm without having run the worst contacts first (simulated device only)");
  run->add_flag("--uncertified", o.uncertified,
                "Allow gains that are not certified (simulated device only; recorded)")
      ->excludes(run->add_option("--certificate", o.certificate,
                                 "Run only what this file of `certify --json` says is certified"));
  addPages(*run, o);
  run->footer(
      "An exercise opens the pages and prints their address first. A scene with a motion,\n"
      "--simulated-clock and --no-web open no port (--port opens it for a scene) and write what\n"
      "--record, --report and --json name, or all three into out/run-<time>/.");
  run->callback([&o, run, &code] {
    const bool scene = run->count("--scene") + run->count("--motion") > 0;
    const bool pages = !o.no_web && !o.simulated_clock && (!scene || run->count("--port") > 0);
    if (const Diagnostics faults = mismatched(*run, o, scene, pages); !faults.empty()) {
      code = refuse(faults);
      return;
    }
    if (!scene) chooseExercise(o);
    if (run->count("--rendering") == 0 && !findGains(o.files.device, o.files.rendering, code)) {
      return;
    }
    o.files.period_s = 1.0 / o.rate_hz;
    if (auto read = pages ? readTokens(o.token_file, o.tokens) : Expected<Done>(Done{}); !read) {
      code = refuse(read.errors());
      return;
    }
    code = pages ? playCommand(o) : runCommand(o);
  });
}

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

  // Checks the output files and rehearses the rig.
  RigOptions rig_options;
  rig_options.period_s = 1.0 / options.rate_hz;
  rig_options.engine = options.engine;
  rig_options.uncertified = options.uncertified;
  rig_options.certificate = *certificate;
  Outputs outputs(options);
  if (auto writable = outputs.check(); !writable) return refuse(writable.errors());
  printDiskRoom(options.record, rig_options.period_s, duration_s);
  RunSafety safety;
  if (!options.simulated_clock && !options.no_rehearsal) {
    RehearsalOptions informs;
    informs.fill_pool = false;  // no person is moved, and no game is connected
    auto rehearsal = rehearse(*models, chosen.player->start(), rig_options, informs);
    if (!rehearsal) return refuse(rehearsal.errors());
    std::printf("  rehearsed %s\n", describe(*rehearsal).c_str());
    safety.rehearsal = std::move(*rehearsal);
  }
  auto rig = buildRig(*models, std::move(chosen.player), rig_options);
  if (!rig) return refuse(rig.errors());
  // A rig that cannot be armed leaves no files.
  if (auto ready = (*rig)->renderer->prepare(); !ready) return refuse(ready.errors());
  if (auto made = outputs.make(); !made) return refuse(made.errors());
  for (const Diagnostic& d : (*rig)->refused) {
    std::printf("  UNCERTIFIED %s\n", format(d).c_str());
  }

  // Plans the run, its messages and its recording.
  RunPlan plan;
  plan.title = titleOf(*models);
  const long long ticks = std::llround(duration_s * options.rate_hz);
  plan.duration_ticks = static_cast<std::uint64_t>(std::max(1LL, ticks));  // 0 would mean endless
  plan.record = options.record;
  plan.black_box = blackBoxPath(options.record);
  plan.simulated_clock = options.simulated_clock;
  plan.seed = options.seed;
  plan.interrupts = &InterruptScope::shared();
  const InterruptScope interrupts;
  Terminal terminal;
  terminal.begin(models->device);
  plan.status = [&](const TickSummary& now, double rate_hz) { terminal.update(now, rate_hz); };
  AsyncLog async_log([&terminal](const std::string& line) { terminal.print(line); });
  plan.notice = [&async_log](const std::string& sentence) { async_log.write(sentence); };
  DeviceModel watched = models->device;
  watched.watch = watchLimits(watched, true);
  SafetyLog log(watched, rig_options.period_s,
                [&async_log](const SafetyTransition& t) { async_log.write(describe(t)); });
  plan.sinks.emplace_back([&log](const TickRecord& record) { log.add(record); });
  AnswerLog answers = answerLogOf(*models);
  plan.sinks.emplace_back([&answers](const TickRecord& record) { answers.add(record); });
  Expected<RunOutcome> outcome = runAndRecord(**rig, plan);
  async_log.flush(kLogWithin);
  terminal.end();
  safety.transitions = log.transitions();
  if (!outcome) {
    outputs.unmake();
    return refuse(outcome.errors());
  }
  printSetup(outcome->setup);
  addThreshold(comparedJson(answers), outcome->results);

  // Writes the results.
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
